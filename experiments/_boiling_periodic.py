"""Position based fluid without walls: a box that repeats, its stages called one by one (V5, V8, V14).

Copies of the particles near a face stand beyond the opposite one and follow their originals after every stage.
"""

import itertools

import numpy as np
from scipy.spatial import cKDTree

from experiments._boiling_rest import D, column
from melt import params as P
from melt.check.compare import stage_function
from melt.errors import SceneError
from melt.position_based import pbf_fields, pbf_of, softening
from melt.stages import STAGES
from melt.state import POSITION, REAL

G = 9.81
DT = 1 / 240
ITERATIONS = (0, 1, 2, 4, 8)
RMS = (0.036, 0.0146, 0.0080, 0.0046, 0.0033)  # V5, the spec's
FLOWS = {  # V14: name -> (k_s, XSPH, iterations)
    "default": (None, 12.0, 4), "without XSPH": (None, 0.0, 4), "k_s 0.1": (0.1, 12.0, 4),
    "k_s 0": (0.0, 12.0, 4), "1 iteration": (None, 12.0, 1),
}


class Box:
    """``cells`` (nx, ny, nz) spacings of liquid that repeats to all sides, each particle moved by up to ``jitter`` d."""

    def __init__(self, cells, jitter=0.0, precision="double", seed=5, **pbf):
        self.real, self.wide = REAL[precision], POSITION[precision]
        points = np.indices(cells).reshape(3, -1)
        rng = np.random.default_rng(seed)
        x = (points + 0.5 + rng.uniform(-jitter, jitter, points.shape)) * D
        self.period, self.core = np.array(cells) * D, x.shape[1]
        scene = column(4, 4, pbf=pbf)
        self.pbf, self.reach = pbf_of(scene, self.real), scene.support
        far = {f"{side}_{axis}": sign * 1e30 for side, sign in (("lower", -1), ("upper", 1)) for axis in "xyz"}
        self.vessel = P.make(P.Vessel, self.real, **far)
        self.fluid = P.make(P.Fluid, self.real, **dict.fromkeys(P.Fluid._fields, 0))
        self.iteration, self.dt = np.int32(0), self.real(DT)
        n, mass = self.core, scene.fluid.density * D**3
        self.kernel_scale = pbf_fields(scene, np.zeros(1, np.int32))["kernel_scale"].astype(self.real)
        self.own = dict(
            position=x.astype(self.wide), velocity=np.zeros((3, n), self.real), mass=np.full(n, mass, self.real),
            rest_volume=np.full(n, D**3, self.real), support_radius=np.full(n, scene.support, self.real),
            iterations=np.full(n, scene.solver.pbf.iterations, np.int32),
        )
        self.surround()

    def surround(self):
        """Give the particles copies around, and list the neighbours of the originals."""
        x = self.own["position"] % self.period[:, None]
        self.own["position"] = x.astype(self.wide)
        shifts, source = [np.zeros((3, self.core))], [np.arange(self.core)]
        for step in itertools.product((-1, 0, 1), repeat=3):
            if any(step):
                shift = np.array(step)[:, None] * self.period[:, None]
                near = ((x + shift > -self.reach) & (x + shift < self.period[:, None] + self.reach)).all(axis=0)
                source.append(np.flatnonzero(near))
                shifts.append(np.repeat(shift, near.sum(), axis=1))
        self.source, self.shift = np.concatenate(source), np.concatenate(shifts, axis=1)
        for name, values in self.own.items():
            setattr(self, name, np.ascontiguousarray(values[..., self.source]))
        self.position += self.shift
        n = self.source.size
        self.phase, self.position_predicted = np.zeros(n, np.int32), self.position.copy()
        self.volume, self.mobility, self.constraint, self.multiplier = (np.zeros(n, self.real) for _ in range(4))
        self.correction, self.velocity_next = np.zeros((3, n), self.real), np.zeros((3, n), self.real)
        self._list()
        self.run("pbf_begin")
        self.active_index, self.active_count = np.arange(n, dtype=np.int32), np.array([self.core], np.int32)

    def _list(self):
        R, x = self.support_radius.astype(float), self.position.astype(float)
        i, j = cKDTree(x.T).query_pairs(self.reach, output_type="ndarray").T
        near = ((x[:, i] - x[:, j]) ** 2).sum(axis=0) < (0.5 * (R[i] + R[j])) ** 2 * (1 - 1e-12)
        i, j = np.concatenate([i[near], j[near]]), np.concatenate([j[near], i[near]])
        keep = i < self.core
        i, j = i[keep], j[keep]
        order = np.lexsort((j, i))
        i, j = i[order], j[order]
        count = np.bincount(i, minlength=x.shape[1])
        self.neighbour_count = count.astype(np.int32)
        self.neighbour_index = np.zeros((count.size, count.max()), np.int32)
        self.neighbour_index[i, np.arange(i.size) - (np.cumsum(count) - count)[i]] = j

    def run(self, name):
        """Run a stage on the CPU; copies follow their originals."""
        stage_function(name, "cpu")(*(getattr(self, a) for a in STAGES[name].arguments))
        copies, originals = slice(self.core, None), self.source[self.core :]
        for field in ("position", "multiplier", "velocity", "velocity_next"):
            if field in STAGES[name].writes:
                values = getattr(self, field)
                values[..., copies] = values[..., originals]
                if field == "position":
                    values[:, copies] += self.shift[:, copies]

    def solve(self, iterations):
        """Correct positions; return the largest momentum error of an iteration over the sum of |m dp|."""
        worst = 0.0
        key = np.array([self.iterations[row[:c]].max(initial=0) for row, c in zip(self.neighbour_index, self.neighbour_count)])
        key = np.maximum(key, self.iterations)[: self.core] if not self.pbf.uniform else np.full(self.core, iterations)
        for k in range(iterations):
            on = np.flatnonzero(key > k)
            self.active_index[: on.size], self.active_count[0], self.iteration = on, on.size, np.int32(k)
            self.correction[:] = 0
            self.run("pbf_lambda")
            self.run("pbf_correction")
            worst = max(worst, imbalance(self.mass[: self.core] * self.correction[:, : self.core].astype(float)))
            self.run("pbf_move")
        return worst

    def step(self, iterations):
        """Take a whole step without gravity."""
        self.run("pbf_predict")
        self._keep()
        self.surround()  # at the prediction, which is what pbf_velocity measures from
        self.solve(iterations)
        self.run("pbf_velocity")
        if self.pbf.blend > 0:
            self.run("pbf_xsph")
            self.velocity, self.velocity_next = self.velocity_next, self.velocity
        self._keep()

    def _keep(self):
        for name in ("position", "velocity"):
            self.own[name] = getattr(self, name)[:, : self.core].copy()


def imbalance(momenta):
    """Return |sum| over the sum of absolute values of vectors (3, n)."""
    return float(np.linalg.norm(momenta.sum(axis=1)) / max(np.linalg.norm(momenta, axis=0).sum(), 1e-300))


def relax(edge, ratio=2.2, **pbf):
    """V5: return r.m.s. C after ITERATIONS; ``eps_rel`` is put in behind the back of the check that refuses it."""
    eps = pbf.pop("eps_rel", None)
    box = Box((edge,) * 3, jitter=0.15, **pbf)
    if eps is not None:
        box.pbf = box.pbf._replace(softening=box.real(eps * softening(column(4, 4))[1]))
    found, done = [], 0
    for target in ITERATIONS:
        box.solve(target - done)
        done = target
        box.run("pbf_lambda")
        found.append(float(np.sqrt((box.constraint[: box.core].astype(float) ** 2).mean())))
    return found


def refused(**pbf):
    """Return whether a scene with these numbers of the solver is refused."""
    try:
        column(4, 4, pbf=pbf)
    except SceneError:
        return True
    return False


def momentum(edge, precision, seed=6):
    """V8: return the relative momentum errors of the solve and of XSPH with random m, V, R, J."""
    box = _random_box(edge, precision, seed)
    solve = box.solve(int(box.iterations.max()))
    before = box.velocity[:, : box.core].astype(float)
    box.run("pbf_xsph")
    change = box.mass[: box.core] * (box.velocity_next[:, : box.core].astype(float) - before)
    return solve, imbalance(change)


def _random_box(edge, precision, seed):
    box, rng = Box((edge,) * 3, jitter=0.2, precision=precision, seed=seed), np.random.default_rng(seed)
    n = box.core
    box.pbf = box.pbf._replace(uniform=np.int32(0))
    mass = float(box.own["mass"][0])
    box.own["mass"] = (mass * rng.uniform(0.5, 2, n)).astype(box.real)
    box.own["rest_volume"] = (D**3 * rng.uniform(0.5, 1.5, n)).astype(box.real)
    box.own["support_radius"] = (D * rng.uniform(1.8, 2.2, n)).astype(box.real)
    box.own["iterations"] = rng.integers(2, 5, n).astype(np.int32)
    box.own["velocity"] = rng.normal(0, 0.5, (3, n)).astype(box.real)
    box.surround()
    return box


def vortices(cells, steps, push, xsph, iterations, jitter=0.15):
    """V14: Taylor-Green vortices of U dt = 0.1 d; return the kinetic energies over the first, step by step.

    They start in a jittered lattice after 120 iterations: a perfect one is a crystal, which swings back.
    """
    given = {"xsph": xsph, "iterations": iterations} | ({} if push is None else {"push": push})
    box = Box(cells, jitter, **given)
    for _ in range(4):
        box.solve(30)
        box._keep()
        box.surround()
    k, U = 2 * np.pi / box.period[:2], 0.1 * D / DT
    x, y = box.own["position"][0] * k[0], box.own["position"][1] * k[1]
    v = U * np.array([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y), 0 * x])
    box.own["velocity"] = v.astype(box.real)
    box.surround()
    energy = [(v**2).sum()]
    for _ in range(steps):
        box.step(iterations)
        energy.append(float((box.own["velocity"].astype(float) ** 2).sum()))
    return np.array(energy) / energy[0]


def viscosity(energy, cells):
    """Return nu over U L of KE = exp(-4 nu k^2 t) between 0.9 and 0.5 of the first energy (L: the box, k = 2 pi/L)."""
    end = np.argmax(energy < 0.5) if (energy < 0.5).any() else len(energy)
    fit = np.flatnonzero(energy[:end] < 0.9)
    fit = np.arange(len(energy)) if fit.size < 3 else np.arange(fit[0], end)
    rate = -np.polyfit(fit, np.log(energy[fit]), 1)[0]
    return rate / (4 * (2 * np.pi / cells[0]) ** 2) / (0.1 * cells[0])
