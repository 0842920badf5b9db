"""Particles at rest on a lattice, stepped by the heat page: the bench of the heat cases."""

import math
from types import SimpleNamespace

import numpy as np

from melt import backend as backends
from melt import params as P
from melt.bind import Plain, Recorder
from melt.state import REAL, State
from melt.systems import heat as page

WATER, ICE = 0, 1


class Slab:
    """A box of (nx, ny, nz) lattice particles, plus ``walls`` layers of fixed temperature below x = 0.

    ``material`` maps columns k, c, rho, L, T_m, melts_to, freezes_to to rows; ``of`` gives each
    particle's row from its lattice coordinates, ``T0`` its temperature from its position.
    """

    def __init__(
        self,
        shape,
        *,
        spacing=0.2,
        ratio=2.5,
        law="paper",
        conductivity=(0.5,),
        specific_heat=(1.0,),
        density=(1.0,),
        latent_heat=(0.0,),
        melting_point=(math.inf,),
        row=None,
        phase=None,
        T0,
        walls=0,
        wall_temperature=0.0,
        jitter=0.0,
        solver="auto",
        precision="double",
        backend="cpu",
        laplacian=P.L_VISC,
        kernel=P.CUBIC,
        full_sweep=0,
        substeps=1,
        tolerance=None,
        seed=1,
        latent=False,
    ):
        real = REAL[precision]
        axes = [np.arange(-walls if a == 0 else 0, n) for a, n in enumerate(shape)]
        lattice = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(3, -1)
        wall = lattice[0] < 0
        x = (lattice + 0.5) * spacing
        x[:, ~wall] += jitter * spacing * np.random.default_rng(seed).uniform(-1, 1, (3, (~wall).sum()))
        row = np.zeros(x.shape[1], int) if row is None else row(lattice)
        n, V, rho = x.shape[1], spacing**3, np.asarray(density)[row]
        rows = len(conductivity)
        support = ratio * spacing
        lower = x.min(axis=1) - 0.5 * spacing
        cells = np.maximum(1, np.ceil((x.max(axis=1) - lower) / support).astype(int) + 1)
        self.spacing, self.V, self.precision = spacing, V, precision
        self.params = {
            "smoothing": P.make(P.Smoothing, real, support=support, kernel=kernel, laplacian=laplacian),
            "grid": P.make(
                P.Grid,
                real,
                origin_x=lower[0],
                origin_y=lower[1],
                origin_z=lower[2],
                inverse_cell=1 / support,
                nx=cells[0],
                ny=cells[1],
                nz=cells[2],
            ),
            "heat": P.make(
                P.Heat,
                real,
                law=P.HEAT_PAPER if law == "paper" else P.HEAT_PHYSICAL,
                current_volume=0,
                full_sweep=full_sweep,
                latent=int(latent),
                ambient_temperature=0,
                ambient_transfer=0,
                full_neighbours=80,
                ambient_area=8 / 3,
                spacing=spacing,
                wall_fixed=int(walls > 0),
            ),
        }
        need = SimpleNamespace(latent=latent, heaters=False, ambient=False, thermostats=False)
        alpha = [2 * k if law == "paper" else k / (r * c) for k, r, c in zip(conductivity, density, specific_heat)]
        self.alpha = max(alpha)
        settings = SimpleNamespace(
            heat_solver=solver,
            heat_substeps=substeps,
            fourier_number=0.0,
            dt=0.1,
            heat_iterations=200,
            heat_tolerance=tolerance or (1e-8 if precision == "double" else 1e-5),
        )
        values = {
            "phase": np.where(wall, 2, 0 if phase is None else phase(lattice)),
            "material": row,
            "position": x,
            "mass": rho * V,
            "rest_volume": np.full(n, V),
            "volume": np.full(n, V),
            "density": rho,
            "temperature": np.where(wall, wall_temperature, T0(x)),
            "id": np.arange(n),
            "material_conductivity": conductivity,
            "material_specific_heat": specific_heat,
            "material_latent_heat": latent_heat,
            "material_melting_point": melting_point,
            "material_melts_to": np.zeros(rows),
            "material_freezes_to": np.full(rows, rows - 1 if latent else -1),
        }
        recorder = Recorder(self.params, need, settings)
        page.start_heat(recorder)
        for name in page.SOLVERS:
            settings.heat_solver = name
            page.heat(recorder, 0.1)
        settings.heat_solver = solver
        self._search(recorder)
        names = dict.fromkeys(["id", *recorder.fields])
        cells_total = int(np.prod(cells)) + 2
        sizes = {
            "particle": n,
            "cell": cells_total,
            "chunk": max(n, cells_total) // 256 + 2,
            "material": rows,
            "neighbour": int((2 * math.ceil(ratio) + 1) ** 3 if jitter else np.sum(_inside(ratio)) - 1),
            "reduction": 64,
        }
        self.state = State(backends.load(backend), precision, sizes, names)
        for name, value in values.items():
            self.state.set(name, np.asarray(value))
        self.do = Plain(self.state.backend, self.state, self.params, need, settings)
        self._search(self.do)
        page.start_heat(self.do)

    @staticmethod
    def _search(do):
        do.cell_index()
        do.cell_sort()
        do.reorder()
        do.neighbours_grid()

    def step(self, dt, steps=1):
        """Advance ``steps`` heat steps of ``dt``."""
        self.do.settings.fourier_number, self.do.settings.dt = self.alpha * dt / self.spacing**2, dt
        for _ in range(steps):
            page.heat(self.do, dt)
        return self

    def melt(self):
        """Make every solid particle whose latent heat is complete liquid (material row 0)."""
        phase, material = self.do.read("phase"), self.do.read("material")
        full = (phase == 1) & (self.read("latent_energy") >= self.read("latent_capacity"))
        phase[full], material[full] = 0, 0
        self.state.set("phase", phase)
        self.state.set("material", material)
        return self

    def read(self, name):
        """Return a float64 (or int) host copy of a field."""
        values = self.do.read(name)
        return values.astype(np.float64) if values.dtype.kind == "f" else values

    def energy(self):
        """Return Sum C T + latent energy, walls left out [J]."""
        C, T = self.read("heat_capacity"), self.read("temperature")
        mobile = np.isfinite(C)
        if not self.params["heat"].latent:
            return float(np.sum(C[mobile] * T[mobile]))
        m, molten, e = (self.read(f)[mobile] for f in ("latent_point", "heat_capacity_molten", "latent_energy"))
        C, T = C[mobile], T[mobile]
        m = np.where(np.isfinite(m), m, 0.0)
        return float(np.sum(np.where(T < m, C, molten) * (T - m) + e))

    def core(self, margin):
        """Return the mask of mobile particles at least ``margin`` from the y and z sides."""
        x = self.read("position")
        inside = self.read("phase") != 2
        for a in (1, 2):
            low, high = x[a].min(), x[a].max()
            inside &= (x[a] >= low + margin - 1e-9) & (x[a] <= high - margin + 1e-9)
        return inside

    def column(self, *fields):
        """Return x and the given fields averaged over the innermost columns (2 x 2 at most), by layer."""
        x = self.read("position")
        centre = np.abs(x[1:] - x[1:].mean(axis=1)[:, None]).max(axis=0) < 0.75 * self.spacing
        centre &= self.read("phase") != 2
        layer = np.round(x[0] / self.spacing - 0.5).astype(int)
        layers = np.unique(layer[centre])
        return [(layers + 0.5) * self.spacing] + [
            np.array([self.read(f)[centre & (layer == k)].mean() for k in layers]) for f in fields
        ]


def _inside(ratio):
    reach = math.ceil(ratio)
    axis = np.arange(-reach, reach + 1)
    x, y, z = np.meshgrid(axis, axis, axis)
    return x**2 + y**2 + z**2 < ratio**2


def wall_plane(ratio=2.5, layers=400):
    """Return where the plane of the wall temperature lies, in spacings from the lattice boundary.

    Layers of one fixed temperature stand in for a Dirichlet plane. A steady profile over such
    walls is a straight line a few layers away; its zero is the plane. Solved on the plane
    weights of the lattice (`L_visc`), so that nothing is fitted to the cases.
    """
    reach = math.ceil(ratio)
    axis = np.arange(-reach, reach + 1)
    x, y, z = np.meshgrid(axis, axis, axis)
    r = np.sqrt(x**2 + y**2 + z**2)
    weight = {k: np.maximum(ratio - r[(x == k) & (r > 0)], 0).sum() for k in range(1, reach)}
    A, b = np.zeros((layers, layers)), np.zeros(layers)
    for i in range(layers):
        for k, w in weight.items():
            A[i, i] += 2 * w
            if i - k >= 0:
                A[i, i - k] -= w
            j = i + k  # beyond the end a line of slope 1 goes on
            if j < layers:
                A[i, j] -= w
            else:
                A[i, layers - 1] -= w
                b[i] += w * (j - layers + 1)
    T = np.linalg.solve(A, b)
    at = np.arange(layers) + 0.5
    mid = slice(layers // 4, layers // 2)
    slope, offset = np.polyfit(at[mid], T[mid], 1)
    return -offset / slope
