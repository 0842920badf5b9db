"""Nodes and APIC particles for the tests of the transfers, in cell order, and how to run a stage on them."""

import numpy as np
from stage_runs import run_with

from melt import params as P
from melt.fields import FIELDS
from melt.state import dtype_of

H = 0.5
W0, W1 = 20.3718327158, 8.6376570716  # cubic spline at 0 and at r = 0.2, h = 0.5
LIQUID, WALL, INACTIVE = 0, 2, 5
APIC = dict(
    support=H, kernel=P.CUBIC, dimension=3, affine=1, literal=0, flip=0.0, rank=1e-3 * H**2, orphan=1e-3 * W0, massless=1e-12,
    most=1e9, rest_density=1000.0,
)
FLUID = {name: 0 for name in P.Fluid._fields} | dict(gravity_z=-10.0)
OPEN = {f"{name}_{axis}": 0.0 for name in ("length", "inverse", "lower") for axis in "xyz"}
TUPLES = dict(
    apic=(P.Apic, APIC),
    smoothing=(P.Smoothing, dict(support=H, kernel=P.CUBIC, laplacian=P.L_VISC)),
    period=(P.Period, OPEN),
    elastic=(P.Elastic, dict(modulus=300.0, relaxation=0.5, dimension=3)),
)
#: Fields with their value where a case does not say otherwise.
NODE = dict(phase=LIQUID, velocity=0.0, velocity_kept=0.0, mass=7.0, volume=0.007, force=0.0, node_state=9)
PARTICLE = dict(
    apic_phase=0, apic_velocity=0.0, apic_affine=0.0, apic_mass=1.0, apic_weight=0.0, apic_centre=0.0, apic_inverse=0.0,
    apic_state=9, apic_id=0,
)


def periodic(lower, cells, edge=H):
    """Return the parameters of a box periodic along the axes that have cells."""
    found = dict(OPEN)
    for axis, low, count in zip("xyz", lower, cells):
        found[f"lower_{axis}"] = low
        if count:
            found[f"length_{axis}"], found[f"inverse_{axis}"] = count * edge, 1 / (count * edge)
    return found


def grid_around(x, period=OPEN, edge=H):
    """Return a grid of cells of an edge that holds points (3, n), and ends with the box along periodic axes."""
    low, count = [], []
    for a, axis in enumerate("xyz"):
        length = period[f"length_{axis}"]
        low.append(period[f"lower_{axis}"] if length else x[a].min(initial=0.0))
        count.append(round(length / edge) if length else max(1, int(np.ceil((x[a].max(initial=0.0) - low[a]) / edge + 1e-9))))
    return dict(zip(("origin_x", "origin_y", "origin_z", "inverse_cell", "nx", "ny", "nz"), (*low, 1 / edge, *count)))


def _order(x, phase, grid):
    """Return the order by cell, and where cells start."""
    count = np.array([grid["nx"], grid["ny"], grid["nz"]])
    origin = np.array([grid["origin_x"], grid["origin_y"], grid["origin_z"]])
    c = np.clip(np.floor((x.T - origin) * grid["inverse_cell"]), 0, count - 1).astype(int)
    cell = np.where(phase == INACTIVE, count.prod(), c[:, 0] + count[0] * (c[:, 1] + count[1] * c[:, 2]))
    order = np.argsort(cell, kind="stable")
    return order, np.searchsorted(cell[order], np.arange(count.prod() + 2))


def sort(a, grid):
    """Bring the fields of a case into cell order, in place."""
    for place, phase, start, names in (
        ("position", "phase", "cell_start", NODE), ("apic_position", "apic_phase", "apic_start", [*PARTICLE, "apic_strain"]),
    ):
        order, a[start] = _order(a[place].astype(float), a[phase], grid)
        a[start] = a[start].astype(np.int32)
        for name in (place, *names):
            a[name] = np.ascontiguousarray(a[name][..., order])


def case(nodes, particles, precision="double", period=OPEN, edge=H, **fields):
    """Return (arrays, grid) of nodes (n, 3) and APIC particles (P, 3), sorted by cell: `apic_id` keeps their order."""
    a = {"position": np.reshape(nodes, (-1, 3)).T, "apic_position": np.reshape(particles, (-1, 3)).T}
    for owner, defaults in (("position", NODE), ("apic_position", PARTICLE)):
        n = a[owner].shape[1]
        for name, value in defaults.items():
            shape = tuple(int(e) if e.isdigit() else n for e in FIELDS[name].shape)
            a[name] = np.broadcast_to(fields.pop(name, value), shape)
    n, p = a["position"].shape[1], a["apic_position"].shape[1]
    a["apic_id"], a["apic_strain"] = np.arange(p), np.tile([[1.0], [1], [1], [0], [0], [0]], p)
    a["neighbour_count"] = np.full(n, n - 1)
    a["neighbour_index"] = np.array([[j for j in range(n) if j != i] for i in range(n)]).reshape(n, max(n - 1, 0))
    a["apic_sums"] = np.zeros((3, 64))
    a.update(fields)
    a = {k: np.ascontiguousarray(v, dtype=dtype_of(FIELDS[k], precision)) for k, v in a.items()}
    grid = grid_around(np.concatenate([a["position"], a["apic_position"]], axis=1).astype(float), period, edge)
    sort(a, grid)
    return a, grid


def run(stage, backend, a, grid, **changes):
    """Run a stage, put what it writes into ``a``; keywords change parameters, or give scalars."""
    return run_with(stage, backend, a, a["apic_mass"].dtype.type, changes, TUPLES | dict(grid=(P.Grid, grid), fluid=(P.Fluid, FLUID)))


def blob(dimension, n, seed=0, radius=1.0):
    """Return nodes (n, 3) and four times as many APIC particles of a disordered disc in the plane y = 0, or ball."""
    rng = np.random.default_rng(seed)

    def fill(count):
        x = rng.uniform(-radius, radius, (40 * count, 3)) * ([1, 0, 1] if dimension == 2 else [1, 1, 1])
        return x[(x**2).sum(axis=1) < radius**2][:count]

    return fill(n), fill(4 * n), rng


def spread(dimension, n, radius=1.0):
    """Return a support with about as many nodes within as in a step: 2.4 spacings."""
    volume = (np.pi if dimension == 2 else 4 / 3 * np.pi) * radius**dimension
    return 2.4 * (volume / n) ** (1 / dimension)


def momentum(m, v):
    """Return the momentum of masses (n,) and velocities (3, n)."""
    return (m * v).sum(axis=1)


def spin(x, m, v):
    """Return the angular momentum."""
    return np.cross(x, m * v, axis=0).sum(axis=1)


def spin_of_particles(a):
    """Return the angular momentum of APIC particles: m (centroid x v + axial of C D)."""
    D = np.zeros((a["apic_mass"].size, 3, 3))
    inverse = a["apic_inverse"]
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        D[:, i, j] = D[:, j, i] = inverse[k]
    D = np.linalg.pinv(D, hermitian=True, rcond=1e-6)
    B = np.moveaxis(a["apic_affine"].reshape(3, 3, -1), 2, 0) @ D
    own = np.stack([B[:, 2, 1] - B[:, 1, 2], B[:, 0, 2] - B[:, 2, 0], B[:, 1, 0] - B[:, 0, 1]])
    m = a["apic_mass"]
    return spin(a["apic_position"] + a["apic_centre"], m, a["apic_velocity"]) + (m * own).sum(axis=1)
