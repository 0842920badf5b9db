"""Lattice bodies for the tests of solids, and a driver that runs stages on plain arrays."""

from types import SimpleNamespace

import numpy as np

from melt.check.compare import stage_function
from melt.fields import FIELDS
from melt.geometry.lattice import lattice_fields
from melt.params import Change, Lattice, make
from melt.stages import STAGES
from melt.state import dtype_of
from melt.systems.topology import build_lattice

DX = 0.2


def lattice(precision="double", **changes):
    """Return the Lattice tuple of the tests: w = 2, Horn's rotation, affected regions refilled."""
    real = np.float64 if precision == "double" else np.float32
    values = dict(
        width=2,
        spacing=DX,
        solid_volume=0,
        solid_scale=1.0,
        rotation=1,
        iterations=30,
        tolerance=1e-14 if precision == "double" else 1e-8,
        stiffness=1.0,
        damping=0.0,
        refill=2,
        connect=26,
    )
    return make(Lattice, real, **{**values, **changes})


def change(precision="double", **changes):
    """Return the Change tuple of the tests: own liquid, no latent heat."""
    real = np.float64 if precision == "double" else np.float32
    values = dict(own_liquid=1, latent=0, hysteresis=0.5, reach=0.6 * DX)
    return make(Change, real, **{**values, **changes})


def box(nx, ny, nz, at=(0, 0, 0)):
    """Return the cells (3, n) of a box, in index order (x slowest)."""
    return np.stack(np.meshgrid(np.arange(nx), np.arange(ny), np.arange(nz), indexing="ij")).reshape(
        3, -1
    ) + np.array(at).reshape(3, 1)


class Drive:
    """Arrays of solids that stages can be run on: one particle per site, in site order."""

    def __init__(
        self, cell, body=None, backend="cpu", precision="double", lattice_params=None, change_params=None
    ):
        cell = np.asarray(cell).reshape(3, -1)
        n = cell.shape[1]
        self.backend, self.precision = backend, precision
        self.lattice = lattice_params or lattice(precision)
        self.params = {"lattice": self.lattice, "change": change_params or change(precision)}
        self.settings = SimpleNamespace(solid_volume="none", crumb=0)
        self.need = SimpleNamespace(nucleation=False)
        self.clock = SimpleNamespace(melted=0, frozen=0)
        w = int(self.lattice.width)
        self.sizes = {
            "particle": n,
            "site": n,
            "link": 27,
            "region": (2 * w + 1) ** 3,
            "reduction": 64,
            "material": 2,
            "neighbour": 1,
        }
        self.arrays = {}
        body = np.zeros(n, np.int32) if body is None else np.asarray(body, np.int32)
        site = np.arange(n, dtype=np.int32)
        self.set(
            id=site,
            phase=np.ones(n),
            material=np.zeros(n),
            site=site,
            position=(cell + 0.5) * DX,
            mass=np.full(n, 7.2),
            rest_volume=np.full(n, DX**3),
            density=np.full(n, 917.0),
            temperature=np.full(n, -10.0),
            site_particle=site,
            site_cell=cell,
            site_rest=cell * DX,
            site_body=body,
            material_melting_point=[0.0, np.inf],
            material_melts_to=[1, 1],
            material_freezes_to=[-1, 0],
            material_density=[900.0, 1000.0],
            **lattice_fields(cell, body, site, int(self.lattice.connect)),
        )

    def set(self, **arrays):
        for name, values in arrays.items():
            self.arrays[name] = np.array(values, dtype_of(FIELDS[name], self.precision), order="C")

    def get(self, name):
        if name not in self.arrays:
            field = FIELDS[name]
            shape = [int(e) if e.isdigit() else self.sizes[e] for e in field.shape]
            self.set(**{name: np.zeros(shape)})
        return self.arrays[name]

    def __getitem__(self, name):
        return self.get(name)

    def run(self, name, **scalars):
        stage = STAGES[name]
        real = np.float64 if self.precision == "double" else np.float32
        given = []
        for a in stage.arguments:
            if a in scalars:
                given.append(np.int32(scalars[a]) if isinstance(scalars[a], int) else real(scalars[a]))
            else:
                given.append(self.params[a] if a in stage.params else self.get(a))
        stage_function(name, self.backend)(*given)

    def __getattr__(self, name):
        if name.startswith("__") or name not in STAGES:
            raise AttributeError(name)
        return lambda **scalars: self.run(name, **scalars)

    def read(self, name):
        return self.get(name).copy()

    def heat(self, sites):
        """Make the particles of these sites hot enough to melt, the others cold."""
        t = np.full(self.sizes["particle"], -10.0)
        t[self["site_particle"][sites]] = 50.0
        self.set(temperature=t)

    def members(self, s):
        """Return the sorted members of the region of site ``s``."""
        row = self["site_region"][s]
        return sorted(row[row >= 0].tolist())


def built(backend, cell, body=None, **kwargs):
    """Return the `Drive` of bodies with their lattice built."""
    do = Drive(cell, body, backend=backend, **kwargs)
    build_lattice(do)
    return do
