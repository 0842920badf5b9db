"""The check scene of the flood: columns whose depth varies by a hundred and whose support by five.

Positions are multiples of 1/256 m, supports of 1/16 m, cells and terrain of powers of two, and neighbour
lists reach 9/8 of the larger support: whether two columns are neighbours, and to which cell or node they
belong, is exact in float32. Lists are made by trying all pairs. NumPy alone, as in `melt.check._cloud`.
"""

import numpy as np

from melt.check._cloud import INACTIVE, LIQUID, RUNAWAY, padded
from melt.check._flood_values import GRID, GROWTH, LARGEST, QUANTUM, RATIO, RINGS, SIGMA, SIZES, SMALLEST, TERRAIN

AIRBORNE = 6
WALL_FIELDS = ("wall_count", "wall_index", "boundary_position", "boundary_area", "boundary_start", "boundary_ring")


def _quantise(x, quantum=QUANTUM):
    return np.round(np.asarray(x, float) / quantum) * quantum


def _special():
    """Return columns that are there to break something: rows x, y, support."""
    x, y = 2.0, 15.0
    return np.array([
        (x, y, 1.0),
        (x + GROWTH, y, 0.75),  # exactly at the reach of both: no neighbours
        (x, y + 1.0, 0.75),  # exactly at the support of the first: listed, without weight
        (x, y - GROWTH + QUANTUM, 1.0),  # just within the reach
        (x - 0.5, y, 0.75),
        (40.0, 40.0, LARGEST),  # isolated, and outside the grid
        (40.0, -20.0, SMALLEST),  # isolated with a support that would grow
        (RUNAWAY, 1.0, 1.0),
        (-3.0, 2.0, 2.0),  # outside the grid, with neighbours within
        (12.5, 30.0, 1.5), (14.25, 30.0, 0.75),  # both outside, in different cells
        (-0.5, 12.0, LARGEST),  # alone at its largest support
    ])


def _columns(n, rng):
    """Return rows x, y, support, volume of n columns: deep water of narrow columns, then shallower and wider ones."""
    special = _special() if n >= 40 else np.zeros((0, 3))
    rest = n - len(special)
    share = [int(0.4 * rest), int(0.35 * rest)] if n >= 40 else [rest, 0]
    parts = []
    for (x, y), spacing, depth, rows, number in (
        ((0, 0), 0.25, 8.0, 12, share[0]),
        ((0, 4), 0.5, 1.0, 10, share[1]),
        ((4, 0), 1.25, 0.08, 8, rest - sum(share)),
    ):
        k = np.arange(number)
        at = np.column_stack([k // rows, k % rows]) + 0.5 + rng.uniform(-0.4, 0.4, (number, 2))
        h = np.clip(_quantise(RATIO * spacing * rng.uniform(0.8, 1.25, number), 1 / 16), SMALLEST, LARGEST)
        V = depth * spacing**2 * rng.uniform(0.7, 1.4, number)
        parts.append(np.column_stack([_quantise(at * spacing + (x, y)), h, V]))
    parts.append(np.column_stack([special, 0.3 * rng.uniform(0.7, 1.4, len(special))]))
    found = np.concatenate(parts)
    if n >= 40:
        found[7, :2] = found[30, :2]  # coincident
        found[8, :2], found[8, 2] = found[31, :2], found[31, 2]  # and alike
    return found


def _phases(n, rng):
    """Return phases: some slots wait for inflow, some columns fall."""
    phase = np.full(n, LIQUID)
    if n >= 40:
        some = 40 + rng.permutation(n - 40 - len(_special()))  # never one that is there to break something
        phase[some[: max(3, n // 40)]] = INACTIVE
        phase[some[-max(4, n // 50) :]] = AIRBORNE
    return phase


def cell_of(x, y):
    """Return the linear cell index, x fastest; those outside the grid are in cells of its edge."""
    c_x = np.clip(np.floor((x - GRID["origin_x"]) * GRID["inverse_cell"]), 0, GRID["nx"] - 1)
    c_y = np.clip(np.floor((y - GRID["origin_y"]) * GRID["inverse_cell"]), 0, GRID["ny"] - 1)
    return (c_y * GRID["nx"] + c_x).astype(np.int64)


def _kernel(r, h):
    """Return the cubic spline in two dimensions and r times its derivative."""
    q = r / h
    c = SIGMA * 40 / (7 * np.pi * h**2)
    W = np.where(q <= 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * np.maximum(1 - q, 0) ** 3)
    return c * W, c * q * np.where(q <= 0.5, 18 * q**2 - 12 * q, -6 * np.maximum(1 - q, 0) ** 2)


def _bed(x, y, z):
    """Return (b, 2 slopes, 3 curvatures): quadratic B-spline of the nodes z (ny, nx)."""
    found, parts = 0.0, []
    for t, count, per in (
        ((x - TERRAIN["origin_x"]) * TERRAIN["inverse_dx"], TERRAIN["nx"], TERRAIN["inverse_dx"]),
        ((y - TERRAIN["origin_y"]) * TERRAIN["inverse_dy"], TERRAIN["ny"], TERRAIN["inverse_dy"]),
    ):
        t = np.clip(t, -2, count + 1)
        k = np.floor(t + 0.5).astype(int)
        u = t - k
        node = np.clip(k + np.arange(-1, 2)[:, None], 0, count - 1)
        weights = (
            np.array([(0.5 - u) ** 2 / 2, 0.75 - u**2, (0.5 + u) ** 2 / 2]), np.array([u - 0.5, -2 * u, u + 0.5]) * per,
            np.array([1 + 0 * u, -2 + 0 * u, 1 + 0 * u]) * per**2,
        )
        parts.append((node, weights))
    (i, w), (j, v) = parts
    nodes = z[j[:, None], i[None, :]]
    found = [np.einsum("bn,an,ban->n", v[m], w[k], nodes) for k, m in ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1))]
    return found[0], np.array(found[1:3]), np.array(found[3:])


def _terrain(rng):
    """Return bed, signed distance to blocked ground, and friction of the nodes: gentle hills, a cliff, a disc."""
    j, i = np.meshgrid(np.arange(TERRAIN["ny"]), np.arange(TERRAIN["nx"]), indexing="ij")
    z = 0.8 * rng.random(i.shape) + 0.06 * i
    z[j > 9] += 6.0
    x, y = TERRAIN["origin_x"] + i / TERRAIN["inverse_dx"], TERRAIN["origin_y"] + j / TERRAIN["inverse_dy"]
    return z, np.hypot(x - 5.5, y - 6.0) - 2.0, rng.uniform(0.02, 0.06, i.shape)


def _boundary(z):
    """Return boundary particles in cell order: a wall of two rows along y = 0, and a block; rows x, y, bed, area."""
    k = np.arange(24)
    wall = np.concatenate([np.column_stack([k * 0.25, np.full(24, y)]) for y in (-0.25, -0.5)])
    i, j = np.divmod(np.arange(20), 5)
    x = _quantise(np.concatenate([wall, np.column_stack([5.0 + 0.5 * i, 4.5 + 0.5 * j])]))
    area = np.where(np.arange(len(x)) < 48, 0.0625, 0.25) * (1 + 0.1 * np.sin(np.arange(len(x))))
    order = np.argsort(cell_of(*x.T), kind="stable")
    x, area = x[order], area[order]
    return x, _bed(x[:, 0], x[:, 1], z)[0], area


def _starts(cell):
    """Return the first element of each cell, and of the two ranges behind the last."""
    return np.searchsorted(np.sort(cell), np.arange(GRID["nx"] * GRID["ny"] + 2), side="left")


def _rings_to(cells):
    """Return the Chebyshev distance of each cell to the nearest of ``cells``."""
    c = np.arange(GRID["nx"] * GRID["ny"])
    if not len(cells):
        return np.full(len(c) + 2, 99)
    apart = np.maximum(*(abs(f(c, GRID["nx"])[:, None] - f(cells, GRID["nx"])[None]) for f in (np.mod, np.floor_divide)))
    return np.append(apart.min(axis=1), [99, 99])


def cell_fields(cell, h, phase):
    """Return the largest support in each cell, and the rings that may hold neighbours, of empty cells too."""
    cells = GRID["nx"] * GRID["ny"]
    support, reach = np.zeros(cells + 2), np.zeros(cells + 2, int)
    np.maximum.at(support, cell[phase != INACTIVE], h[phase != INACTIVE])
    x, y = np.mod(np.arange(cells), GRID["nx"]), np.arange(cells) // GRID["nx"]
    for c in range(cells):
        ring = np.maximum(abs(x - x[c]), abs(y - y[c]))
        for k in range(1, RINGS + 1):
            most = max(support[c], support[:cells][ring == k].max(initial=0))
            reach[c] = k if GROWTH * most > k - 1 else reach[c]
    return support, reach


def _water(arrays, r, rng):
    """Return depth, factor and state that fit supports and lists; walls aside."""
    phase, h, V = arrays["phase"], arrays["support_radius"], arrays["rest_volume"]
    liquid = phase == LIQUID
    W, rdW = _kernel(r, np.where(h > 0, h, 1.0)[:, None])
    d = (W * (V * liquid)[None, :]).sum(axis=1)
    factor = -(rdW * (V * liquid)[None, :]).sum(axis=1) / np.where(d > 0, 2 * d, 1.0)
    bound = (h == LARGEST) | (factor < 0.2)
    few = arrays["neighbour_count"] < 3
    state = (h == LARGEST) + 2 * (h == SMALLEST) + 4 * (rng.random(len(h)) < 0.05) + 8 * few
    return dict(
        depth=np.where(phase == INACTIVE, 0.0, d), support_factor=np.where(bound | ~liquid, 1.0, factor),
        depth_state=np.where(liquid, state, 0),
    )


def _motion(arrays, rng):
    """Return velocity, acceleration, brake and the position before the last move."""
    n, phase = len(arrays["phase"]), arrays["phase"]
    v = rng.normal(size=(3, n)) * np.where(rng.random(n) < 0.2, 8.0, 1.5)
    v[2] = np.where(phase == AIRBORNE, -3.0, 0.0)
    v[:2, np.arange(n) % 11 == 0] = 0.0  # at rest
    moved = np.where(np.arange(n) % 5 == 0, 0.0, 1 / 64) * v
    moved[:, np.arange(n) % 7 == 1] *= 40.0  # further than the probe
    brake = np.where(phase == LIQUID, rng.uniform(-1, 4, n), 0.0) * (np.arange(n) % 3 > 0)
    return dict(
        velocity=v, acceleration=rng.normal(size=(2, n)) * 10.0 * (phase == LIQUID), brake=brake,
        position_before=arrays["position"] - moved,
    )


def _openings(rng):
    """Return the columns that enter and the zones; one zone holds no column."""
    x = _quantise(np.array([[0.5, 1.5, 2.0, 30.0, 6.0], [0.5, 6.0, 15.0, 2.0, 3.0], [1.0, 2.0, 0.5, 1.5, 1.0]]))
    return dict(
        entry_position=x, entry_velocity=np.vstack([rng.normal(size=(2, 5)), np.zeros(5)]), entry_volume=rng.uniform(0.1, 0.5, 5),
        zone_box=np.array([[0.0, 1.0, 0.0, 3.0], [0.0, 5.0, 4.0, 5.5], [20.0, 21.0, 0.0, 1.0]]).T,
        zone_probe=np.array([[1.0, 2.5, 0.0, 3.0], [0.0, 5.0, 5.5, 7.0], [21.0, 22.0, 0.0, 1.0]]).T,
        zone_normal=np.array([[1.0, 0.6, 0.0], [0.0, 0.8, -1.0]]), zone_speed=np.array([1.25, -0.5, 2.0]),
    )


def _samples(arrays, z, rng):
    """Return points of a map and gauges, wet and dry, one at a column, and what was largest there so far."""
    i, j = np.divmod(np.arange(63), 9)
    x = np.column_stack([i * 2.0 + 0.25, j * 1.5 - 1.5])
    if arrays["phase"].size:
        x[20] = arrays["position"][:2, arrays["phase"].size // 3]
    x[50] = 60.0, 60.0
    m, wet = len(x), rng.random(len(x)) < 0.6
    d, speed = rng.uniform(0, 2, m) * wet, rng.uniform(0, 3, m) * wet
    b = _bed(*x.T, z)[0]
    arrival = np.where(rng.random(m) < 0.5, rng.uniform(0, 2, m), -1.0)
    return dict(
        sample_position=x.T, sample_bed=b, sample_surface=b + d, sample_depth=d, sample_speed=speed, sample_column=d * 1.1,
        most_depth=rng.uniform(0, 2, m), most_speed=rng.uniform(0, 3, m), most_flux=rng.uniform(0, 5, m), arrival_time=arrival,
        wet_time=np.where(arrival >= 0, rng.uniform(0, 1, m), 0.0),
    )


def scene(n, seed):
    """Return (arrays, grid) of the flood in float64 and int64."""
    rng = np.random.default_rng(seed)
    columns, phase = _columns(n, rng), _phases(n, rng)
    cell = np.where(phase == INACTIVE, GRID["nx"] * GRID["ny"], cell_of(*columns[:, :2].T))
    order = np.argsort(cell, kind="stable")
    columns, phase, cell = columns[order], phase[order], cell[order]
    z, wall, friction = _terrain(rng)
    x, y, h, V = columns.T
    b, slope, curvature = _bed(x, y, z)
    beside, beside_bed, area = _boundary(z)
    with np.errstate(over="ignore"):
        r = np.hypot(x[:, None] - x, y[:, None] - y)
        r_b = np.hypot(x[:, None] - beside[:, 0], y[:, None] - beside[:, 1])
    near = (r < GROWTH * np.maximum(h[:, None], h)) & (phase == LIQUID)[None] & (phase != INACTIVE)[:, None] & ~np.eye(n, dtype=bool)
    near_b = (r_b < GROWTH * h[:, None]) & (phase == LIQUID)[:, None]
    count, index = padded([np.flatnonzero(row) for row in near])
    wall_count, wall_index = padded([np.flatnonzero(row) for row in near_b])
    support, reach = cell_fields(cell, h, phase)
    cells = cell_of(*beside.T)
    arrays = dict(
        phase=phase, id=rng.permutation(n), rest_volume=V, mass=1000 * V, support_radius=h, bed=np.where(phase == INACTIVE, 0.0, b),
        bed_slope=slope, bed_curvature=curvature, cell_start=_starts(cell), cell_support=support, cell_reach=reach,
        neighbour_count=count, neighbour_index=index, wall_count=wall_count, wall_index=wall_index,
        boundary_position=np.vstack([beside.T, beside_bed]), boundary_area=area, boundary_start=_starts(cells),
        boundary_ring=_rings_to(np.unique(cells)), terrain=z.ravel(), terrain_wall=wall.ravel(), terrain_friction=friction.ravel(),
    )
    arrays.update(_water(arrays, r, rng))
    # just above the water and just in it, so that another column's bed decides otherwise
    above = np.where(rng.uniform(-0.5, 1.0, n) < 0.25, -1 / 64, 1 / 64)
    height = arrays["bed"] + arrays["depth"] + np.where(phase == AIRBORNE, above, 0.0)
    arrays["position"] = np.vstack([x, y, height])
    for part in (_motion(arrays, rng), _openings(rng), _samples(arrays, z, rng)):
        arrays.update(part)
    return arrays, dict(GRID)


def sizes(arrays):
    """Return the size of every extent that a field of the flood may have."""
    return dict(
        SIZES, particle=len(arrays["phase"]), neighbour=arrays["neighbour_index"].shape[1], cell=len(arrays["cell_start"]),
        boundary=len(arrays["boundary_area"]), wall_neighbour=arrays["wall_index"].shape[1], sample=len(arrays["sample_bed"]),
        reduction=64,
    )


def adapted(arrays, choice):
    """Return the scene as its variant asks: without walls, maps or room in the lists."""
    arrays = dict(arrays)
    for index, capacity in (("neighbour_index", "capacity"), ("wall_index", "wall_capacity")):
        if capacity in choice:
            arrays[index] = arrays[index][:, : choice[capacity]]
    if choice.get("walls") == 0:
        for name in WALL_FIELDS:
            arrays[name] = arrays[name][..., :0][:0] if name == "wall_index" else arrays[name][..., :0]
    if choice.get("mapped") == 0:
        arrays["terrain_friction"] = np.zeros(0)
    if choice.get("guard") == 0:
        arrays["terrain_wall"] = np.zeros(0)
    return arrays
