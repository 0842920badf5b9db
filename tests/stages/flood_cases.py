"""Columns with brute-force lists, grids, walls and terrains for the tests of depth, bed and neighbours of a flood."""

import numpy as np

from melt import params as P
from melt.check.compare import run_stage
from melt.fields import FIELDS
from melt.stages import STAGES
from melt.state import dtype_of

LIQUID, INACTIVE, AIRBORNE = 0, 5, 6
RATIO = 2.66
FLOOD = dict(
    gravity=9.81, kernel=P.CUBIC, sigma=1.0, ratio=RATIO, smallest=0.25 * RATIO, largest=5 * RATIO, growth=1.1, iterations=20,
    tolerance=1e-12, form=0, stiffness=10.0, reference_depth=1.0, clamp=0, lax_friedrichs=1.0, viscosity=0.0, wall_mirror=1,
    shortest_wall=0.3, front=0.02,
)
GRID = dict(origin_x=0.0, origin_y=0.0, origin_z=0.0, inverse_cell=1.0, nx=8, ny=6, nz=1)
TERRAIN = dict(origin_x=0.0, origin_y=0.0, inverse_dx=1.0, inverse_dy=1.0, nx=8, ny=6, sampler=P.SAMPLER_BSPLINE)
TUPLES = dict(flood=(P.Flood, FLOOD), grid=(P.Grid, GRID), terrain_grid=(P.Terrain, TERRAIN))
FILES = ("flood_cells", "flood_neighbours", "flood_bed", "flood_depth")
#: Discrete normalisation, sum of W A over a lattice minus 1, of both kernels on square and hexagonal lattices. Flood spec 0.
EXCESS = {(P.CUBIC, "square"): 0.0005, (P.CUBIC, "hexagonal"): 0.0047, (P.WENDLAND2, "square"): 0.0090, (P.WENDLAND2, "hexagonal"): 0.0079}


def kernel(r, h, wendland=False):
    """W(r, h) as printed, with the smoothing length l = h/2."""
    ell, q = h / 2, 2 * np.asarray(r) / h
    if wendland:
        return 7 / (4 * np.pi * ell**2) * np.maximum(1 - q / 2, 0) ** 4 * (1 + 2 * q)
    return 10 / (7 * np.pi * ell**2) * np.where(q < 1, 1 - 1.5 * q**2 + 0.75 * q**3, 0.25 * np.maximum(2 - q, 0) ** 3)


def lattice(kind, half=8, spacing=1.0):
    """Lattice points (n, 2) of a cell of area spacing^2, the origin in the middle of the list."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(-half, half + 1), np.arange(-half, half + 1)))
    if kind == "square":
        return spacing * np.column_stack([i, j]).astype(float)
    a = spacing * np.sqrt(2 / np.sqrt(3))
    return np.column_stack([a * (i + 0.5 * j), a * np.sqrt(3) / 2 * j])


def cells_of(x, grid):
    """Cell numbers of places (n, 2); NaN counts as 0."""
    count = np.array([grid["nx"], grid["ny"]])
    t = (np.asarray(x, float) - (grid["origin_x"], grid["origin_y"])) * grid["inverse_cell"]
    with np.errstate(invalid="ignore"):
        c = np.clip(np.floor(np.where(np.isnan(t), 0, t)), 0, count - 1).astype(int)
    return c[:, 1] * grid["nx"] + c[:, 0]


def in_order(x, phase, grid):
    """Return the order of columns by cell, the inactive last, and the start of each cell."""
    cells = grid["nx"] * grid["ny"]
    cell = np.where(np.broadcast_to(phase, len(x)) == INACTIVE, cells, cells_of(x, grid))
    order = np.argsort(cell, kind="stable")
    return order, np.searchsorted(cell[order], np.arange(cells + 2))


def near(x, h, phase, growth=FLOOD["growth"]):
    """All pairs: rows of the columns of water within growth max(h_i, h_j)."""
    with np.errstate(invalid="ignore"):
        r = np.hypot(*(x[:, None] - x[None]).transpose(2, 0, 1))
    found = (r < growth * np.maximum(h[:, None], h)) & (phase == LIQUID)[None] & np.isin(phase, (LIQUID, AIRBORNE))[:, None]
    np.fill_diagonal(found, False)
    return [np.flatnonzero(row) for row in found]


def lists(rows):
    """Counts and padded index."""
    count = np.array([len(row) for row in rows], dtype=int)
    index = np.full((len(rows), max(4, count.max(initial=0))), -987654321)
    for i, row in enumerate(rows):
        index[i, : len(row)] = row
    return count, index


def arrays(x, V=1.0, h=RATIO, phase=LIQUID, precision="double", walls=None, growth=FLOOD["growth"], grid=GRID, ordered=False, **fields):
    """Return all fields of these stages for columns at x (n, 2).

    ``walls`` are rows x, y, z, area of boundary particles (sorted by cell here), none: a scene without any;
    ``ordered``: columns are brought into the order of the cells of ``grid``, as a search needs.
    """
    x = np.asarray(x, float).reshape(-1, 2)
    n, cells = len(x), grid["nx"] * grid["ny"]
    V, h, phase = (np.broadcast_to(np.asarray(a), n) for a in (V, h, phase))
    order, start = in_order(x, phase, grid)
    if ordered:
        x, V, h, phase = x[order], V[order], h[order], phase[order]
    count, index = lists(near(x, h, phase, growth))
    given = dict(
        position=np.vstack([x.T, np.zeros(n)]), phase=phase, rest_volume=V, support_radius=h, bed=np.zeros(n), cell_start=start,
        neighbour_count=count, neighbour_index=index, terrain=np.zeros(TERRAIN["nx"] * TERRAIN["ny"]), bed_slope=np.zeros((2, n)),
        bed_curvature=np.zeros((3, n)), depth=np.zeros(n), support_factor=np.zeros(n), depth_state=np.zeros(n),
        cell_support=np.zeros(cells + 2), cell_reach=np.zeros(cells + 2), wall_count=np.zeros(0), wall_index=np.zeros((0, 0)),
        boundary_position=np.zeros((3, 0)), boundary_area=np.zeros(0), boundary_start=np.zeros(0), boundary_ring=np.zeros(0),
    )
    if walls is not None:
        b = np.asarray(walls, float).reshape(-1, 4)
        own = cells_of(b[:, :2], grid)
        b, own = b[np.argsort(own, kind="stable")], np.sort(own)
        apart = np.hypot(*(x[:, None] - b[None, :, :2]).transpose(2, 0, 1))
        beside = (apart < growth * h[:, None]) & (phase == LIQUID)[:, None]
        given["wall_count"], given["wall_index"] = lists([np.flatnonzero(row) for row in beside])
        c = np.arange(cells)
        ring = np.maximum(abs(c[:, None] % grid["nx"] - own % grid["nx"]), abs(c[:, None] // grid["nx"] - own // grid["nx"]))
        given.update(
            boundary_position=b[:, :3].T, boundary_area=b[:, 3], boundary_start=np.searchsorted(own, np.arange(cells + 2)),
            boundary_ring=np.append(ring.min(axis=1, initial=99), [99, 99]),
        )
    given.update(fields)
    return {k: np.ascontiguousarray(v, dtype=dtype_of(FIELDS[k], precision)) for k, v in given.items()}


def run(stage, backend, a, **changes):
    """Run a stage, put what it writes into ``a`` and return that; keywords change parameters or give scalars."""
    real = a["rest_volume"].dtype.type
    params = {}
    for name in STAGES[stage].params:
        if name in TUPLES:
            kind, values = TUPLES[name]
            params[name] = P.make(kind, real, **{**values, **{k: v for k, v in changes.items() if k in values}})
        else:
            params[name] = np.int32(changes[name])
    out = run_stage(stage, backend, a, params)
    a.update(out)
    return out
