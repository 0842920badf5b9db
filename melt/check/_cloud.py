"""Particles of the check inputs: a cloud with everything that has ever gone wrong in one.

Lengths are multiples of 3/16 m and positions of 1/4096 m, so that differences, squared distances
and their comparison with the support, the grid cell, the guard and the contact distance are exact
in float32 too: whether two particles are neighbours never depends on rounding. Built with NumPy
and SciPy alone; the harness must not depend on what it checks.
"""

import numpy as np
from scipy.spatial import cKDTree

SPACING = 3 / 16
SUPPORT = 15 / 32
QUANTUM = 2.0**-12
CELL = 0.5  # edge of a grid cell, a power of two and not less than the support
LIQUID, SOLID, WALL, INACTIVE = 0, 1, 2, 5
RUNAWAY = 2.0**30  # a particle so far away that its cell index overflows int32


def quantise(x):
    """Round to the quantum of positions."""
    return np.round(np.asarray(x) / QUANTUM) * QUANTUM


def body_cells(n):
    """Return the voxels of each body, list of (cells, 3) int arrays; none if n is too small for them."""
    if n < 150:
        return []
    a = 5 if n >= 700 else 3
    box = np.stack(np.meshgrid(*[np.arange(a)] * 3, indexing="ij"), -1).reshape(-1, 3)
    cube = box + (2, 2, 1)
    # touches the cube face to face: two bodies in adjacent voxels must not bond
    plate = box[box[:, 0] == 0] + (2 + a, 2, 1)
    chain = np.array([(0, 0, 2), (1, 0, 2), (2, 0, 2)])
    single = np.array([(5, 0, 3)])
    u_shape = np.array([(0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0)])
    u_shape = np.column_stack([u_shape, np.full(7, 1)])[:, [0, 2, 1]] + (2, 0, 4)
    return [cube, plate, chain, single, u_shape]


def melted_sites(bodies):
    """Return three sites whose particles melted earlier: of the plate, the end of the U, of a large cube."""
    if not bodies:
        return np.zeros(0, int)
    cube, last = len(bodies[0]), sum(len(c) for c in bodies) - 1
    # a small cube stays whole: it has only one inner site
    return np.array([cube + 3, last, cube + 1] if cube == 27 else [0, last, cube + 1])


def _rotation(axis, angle):
    k = np.asarray(axis, float) / np.linalg.norm(axis)
    K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def _solids(bodies, rng):
    """Positions of the bodies' particles: turned a little about their middle, and dented."""
    parts = []
    for b, cells in enumerate(bodies):
        x = (cells + 0.5) * SPACING
        middle = x.mean(axis=0)
        R = _rotation(rng.normal(size=3), 0.05 + 0.04 * b)
        dent = rng.uniform(-0.03, 0.03, x.shape) * SPACING
        parts.append((x - middle) @ R.T + middle + dent)
    return np.concatenate(parts) if parts else np.zeros((0, 3))


def _fill(taken, footprint, layers, count):
    """First ``count`` free voxels of a column, from below."""
    z, y, x = np.meshgrid(np.arange(layers), np.arange(footprint), np.arange(footprint), indexing="ij")
    cells = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    keep = np.array([tuple(c) not in taken for c in cells])
    return cells[keep][:count]


def _special(liquid, solid, wall, vacant):
    """Liquid particles that are there to break something."""
    far = np.array([40.0, 40.0, 40.0]) * SPACING
    support = np.array([60.0, 8.0, 8.0]) * SPACING
    points = [
        far,  # isolated
        support,
        support + (SUPPORT, 0, 0),  # exactly at the support: not neighbours
        support + (0, 0, 4),
        support + (0, SUPPORT - QUANTUM, 4),  # just within it
        (RUNAWAY, 1.0, -3.0),
    ]
    if len(liquid):
        points.append(liquid[len(liquid) // 2])  # two liquid particles at one place
    if len(solid):
        points.append(solid[len(solid) // 3])  # a liquid particle at the place of a solid one
        # offenders of the guard: two at one solid particle, one at a wall
        points += [solid[len(solid) // 2] + (0.05, 0.02, 0), solid[len(solid) // 2] + (-0.04, 0.06, 0.01)]
        points.append(wall[len(wall) // 2] + (0, 0.01, 0.06))
        # two more that could freeze to each of the vacant sites
        points += [x + d for x in vacant for d in ((0.03, 0.02, -0.04), (-0.05, 0.04, 0.01))]
    return np.array(points)


def _points(n, rng):
    """Return positions (n, 3), phase and site of ``n`` particles before sorting."""
    bodies = body_cells(n)
    solid = _solids(bodies, rng)
    melted = melted_sites(bodies)
    footprint = 10 if n >= 700 else 8
    wall_layers = 0 if not bodies else (2 if n >= 700 else 1)
    z, y, x = np.meshgrid(
        np.arange(-wall_layers, 0), np.arange(footprint), np.arange(footprint), indexing="ij"
    )
    wall = (np.column_stack([x.ravel(), y.ravel(), z.ravel()]) + 0.5) * SPACING
    inactive = 0 if n < 40 else max(3, n // 40)
    special = _special(np.zeros((1, 3)), solid, wall, solid[melted]) if n >= 40 else np.zeros((0, 3))
    liquids = n - len(solid) - len(wall) - inactive - len(special)
    taken = {tuple(c) for cells in bodies for c in cells}
    cells = _fill(taken, footprint, 4 + n // footprint**2, liquids)
    # one in ten strays far enough to come closer to a solid or a wall than the guard allows
    stray = np.where(rng.random((len(cells), 1)) < 0.1, 0.6, 0.15)
    liquid = (cells + 0.5 + rng.uniform(-1, 1, cells.shape) * stray) * SPACING
    if len(special):
        special = _special(quantise(liquid), quantise(solid), wall, solid[melted])[: len(special)]
    # slots of deleted particles keep stale values: they lie amid the others
    stale = rng.uniform(0, footprint * SPACING, (inactive, 3))
    x = np.concatenate([solid, wall, liquid, special, stale])
    phase = np.repeat(
        [SOLID, WALL, LIQUID, INACTIVE], [len(solid), len(wall), len(liquid) + len(special), inactive]
    )
    site = np.concatenate([np.arange(len(solid)), np.full(n - len(solid), -1)])
    phase[melted] = LIQUID
    return quantise(x), phase, site


def grid_of(position, phase, n):
    """Return the grid as a dict: it ends before the cloud does, so that border cells clamp."""
    footprint = (10 if n >= 700 else 8) * SPACING
    size = np.array([footprint - CELL, footprint, footprint + CELL])
    counts = np.maximum(1, np.floor(size / CELL)).astype(int)
    origin = np.array([0.0, 0.0, -CELL])
    return dict(
        origin_x=origin[0],
        origin_y=origin[1],
        origin_z=origin[2],
        inverse_cell=1 / CELL,
        nx=int(counts[0]),
        ny=int(counts[1]),
        nz=int(counts[2]),
    )


def cell_of(position, phase, grid):
    """Return the linear cell index, x fastest; inactive particles are in the range behind the last cell."""
    origin = np.array([grid["origin_x"], grid["origin_y"], grid["origin_z"]])
    counts = np.array([grid["nx"], grid["ny"], grid["nz"]])
    c = np.floor((position - origin) * grid["inverse_cell"])
    c = np.clip(c, 0, counts - 1).astype(np.int64)
    cell = (c[:, 2] * counts[1] + c[:, 1]) * counts[0] + c[:, 0]
    return np.where(phase == INACTIVE, counts.prod(), cell)


def neighbour_rows(position, phase):
    """Return the sorted neighbours of each particle: r < h, without itself; walls and inactive have none."""
    active = np.flatnonzero(phase != INACTIVE)
    tree = cKDTree(position[active])
    rows = [np.zeros(0, int)] * len(position)
    for i in active[phase[active] != WALL]:
        near = active[np.array(tree.query_ball_point(position[i], SUPPORT * 1.001), dtype=int)]
        r2 = ((position[near] - position[i]) ** 2).sum(axis=1)
        rows[i] = np.sort(near[(r2 < SUPPORT**2) & (near != i)])
    return rows


def padded(rows, capacity=None):
    """Return neighbour_count and neighbour_index; unused places hold a sentinel, not 0."""
    count = np.array([len(r) for r in rows], dtype=int)
    capacity = max(int(count.max(initial=0)) + 3, 4) if capacity is None else capacity
    index = np.full((len(rows), capacity), -987654321)
    for i, row in enumerate(rows):
        index[i, : min(len(row), capacity)] = row[:capacity]
    return count, index


def cloud(n, seed, ordered=True):
    """Return (arrays, grid) of the particles; position is (3, n) float64, ``ordered``: sorted by cell."""
    rng = np.random.default_rng(seed)
    position, phase, site = _points(n, rng)
    grid = grid_of(position, phase, n)
    shuffle = rng.permutation(n)
    position, phase, site = position[shuffle], phase[shuffle], site[shuffle]
    if ordered:
        order = np.argsort(cell_of(position, phase, grid), kind="stable")
        position, phase, site = position[order], phase[order], site[order]
    arrays = dict(position=np.ascontiguousarray(position.T), phase=phase, site=site)
    cell = cell_of(position, phase, grid)
    cells = grid["nx"] * grid["ny"] * grid["nz"]
    arrays.update(id=rng.permutation(n), cell=cell, order=np.argsort(cell, kind="stable"))
    # entry c is the first particle of cell c; the inactive have the range behind the last cell
    arrays["cell_start"] = np.searchsorted(np.sort(cell), np.arange(cells + 2), side="left")
    rows = neighbour_rows(position, phase)
    arrays["neighbour_count"], arrays["neighbour_index"] = padded(rows)
    return arrays, grid, rng
