"""Grid, sort, reordering and neighbour lists: reference, CPU and emulated CUDA."""

import numba
import numpy as np
import pytest

from melt import _compile
from melt import params as P
from melt.check.compare import SENTINEL, run_stage
from melt.cpu import neighbours as cpu_neighbours
from melt.cpu._compress import AVAILABLE, LANES

BACKENDS = ["reference", "cpu", "cuda"]
PRECISIONS = {"single": ("f4", "f4"), "mixed": ("f8", "f4"), "double": ("f8", "f8")}
LIQUID, SOLID, WALL, INACTIVE = 0, 1, 2, 5
SUPPORT = 0.46875  # 15/32: with positions in 1/4096 m every comparison is exact in float32


pytestmark = pytest.mark.usefixtures("emulated")


def smoothing_of(real, support=SUPPORT):
    return P.make(P.Smoothing, real, support=support, kernel=0, laplacian=0)


def grid_of(real, counts=(4, 3, 5), origin=(0.0, 0.0, 0.0), cell=0.5):
    return P.make(
        P.Grid, real, origin_x=origin[0], origin_y=origin[1], origin_z=origin[2], inverse_cell=1 / cell,
        nx=counts[0], ny=counts[1], nz=counts[2],
    )


def brute(position, phase, support):
    """Return the list of each particle by the definition, as Python lists."""
    x = position.astype(float)
    rows = []
    for i in range(x.shape[1]):
        r2 = ((x - x[:, i, None]) ** 2).sum(axis=0)
        near = (r2 < support**2) & (phase != INACTIVE) & (np.arange(x.shape[1]) != i)
        rows.append(np.flatnonzero(near).tolist() if phase[i] in (LIQUID, SOLID) else [])
    return rows


def cloud(n, seed, wide):
    """Return positions and phases with coincident pairs, pairs at the support, strays, all phases."""
    rng = np.random.default_rng(seed)
    x = np.round(rng.uniform(-0.3, [[2.3], [1.8], [2.8]], (3, n)) * 4096) / 4096
    x[:, 1::17] = x[:, 0:-1:17][:, : x[:, 1::17].shape[1]]  # coincident
    m = x[:, 3::19].shape[1]
    x[:, 3::19] = x[:, 2::19][:, :m] + np.array([[SUPPORT], [0], [0]])  # exactly at the support
    x[:, n // 2] = 2.0**30, -(2.0**30), 5.0
    x[:, n // 3] = -7.0, 9.0, 2.0
    phase = rng.choice([LIQUID, SOLID, WALL, INACTIVE], n, p=[0.4, 0.3, 0.2, 0.1]).astype(np.int32)
    phase[[n // 2, n // 3]] = LIQUID
    return x.astype(wide), phase


def sorted_by_cell(position, phase, grid, backend="reference"):
    """Return position and phase in cell order, and cell_start, made by the stages of a backend."""
    n = phase.size
    a = dict(position=position, phase=phase, cell=np.empty(n, np.int32))
    a.update(run_stage("cell_index", backend, a, {"grid": grid}))
    cells = grid.nx * grid.ny * grid.nz + 2
    a.update(
        order=np.empty(n, np.int32), cell_start=np.empty(cells, np.int32), arrival=np.empty(n, np.int32),
        chunk_sum=np.empty(-(-max(n, cells) // 256), np.int32),
    )
    a.update(run_stage("cell_sort", backend, a, {}))
    return position[:, a["order"]].copy(), phase[a["order"]].copy(), a["cell_start"]


def lists(backend, position, phase, cell_start, grid, smoothing, capacity):
    n = phase.size
    a = dict(
        position=position, phase=phase, cell_start=cell_start, neighbour_count=np.empty(n, np.int32),
        neighbour_index=np.empty((n, capacity), np.int32),
    )
    out = run_stage("neighbours_grid", backend, a, {"grid": grid, "smoothing": smoothing})
    return out["neighbour_count"], out["neighbour_index"]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("wide", ["f4", "f8"])
def test_cell_index_by_hand(backend, wide):
    grid = grid_of(np.dtype(wide).type, counts=(4, 3, 5), origin=(-1.0, 0.0, 0.0))
    # inside; on a face (upper cell); below and above (clamped); far; infinite; NaN (cell 0); inactive
    x = [-0.9, -0.5, -5.0, 9.0, 1e9, np.inf, np.nan, 0.0]
    y = [0.1, 0.5, 0.2, 9.0, -1e9, -np.inf, 0.7, 0.0]
    z = [0.1, 1.0, 0.2, 9.0, 1e30, np.inf, 1.2, 0.0]
    position = np.array([x, y, z], dtype=wide)
    phase = np.array([0, 0, 1, 2, 0, 0, 0, INACTIVE], dtype=np.int32)
    a = dict(position=position, phase=phase, cell=np.empty(8, np.int32))
    cell = run_stage("cell_index", backend, a, {"grid": grid})["cell"]
    expected = [0, 1 + 4 * (1 + 3 * 2), 0, 59, 3 + 4 * (0 + 3 * 4), 51, 0 + 4 * (1 + 3 * 2), 60]
    assert cell.tolist() == expected


@pytest.mark.parametrize("backend", BACKENDS)
def test_cell_sort_is_stable_by_hand(backend):
    cell = np.array([3, 0, 4, 3, 1, 3, 4, 0], dtype=np.int32)  # 4 cells; 4 is inactive
    a = dict(
        cell=cell, order=np.empty(8, np.int32), cell_start=np.empty(6, np.int32),
        arrival=np.empty(8, np.int32), chunk_sum=np.empty(1, np.int32),
    )
    out = run_stage("cell_sort", backend, a, {})
    assert out["order"].tolist() == [1, 7, 4, 0, 3, 5, 2, 6]
    assert out["cell_start"].tolist() == [0, 2, 3, 3, 6, 8]


@pytest.mark.parametrize("n, cells", [(0, 1), (1, 1), (255, 3), (256, 700), (1500, 9), (1500, 100000)])
def test_cell_sort_agrees(n, cells):
    """n and cells on both sides of the scan's chunk, crowded and mostly empty cells."""
    cell = np.random.default_rng(n + cells).integers(0, cells + 1, n).astype(np.int32)
    a = dict(
        cell=cell, order=np.empty(n, np.int32), cell_start=np.empty(cells + 2, np.int32),
        arrival=np.empty(n, np.int32), chunk_sum=np.empty(-(-max(n, cells + 2) // 256), np.int32),
    )
    for backend in BACKENDS:
        out = run_stage("cell_sort", backend, a, {})
        assert np.array_equal(out["order"], np.argsort(cell, kind="stable"))
        assert out["cell_start"][-1] == n and out["cell_start"][0] == 0
        assert np.array_equal(np.diff(out["cell_start"]), np.bincount(cell, minlength=cells + 1))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("kind", ["i4", "f4", "f8"])
def test_reorder(backend, kind):
    rng = np.random.default_rng(1)
    order = rng.permutation(37).astype(np.int32)
    for name, shape in (("reorder_scalar", (37,)), ("reorder_vector", (3, 37))):
        source = (rng.random(shape) * 1000).astype(kind)
        a = dict(order=order, source=source, target=np.empty_like(source))
        target = run_stage(name, backend, a, {})["target"]
        assert np.array_equal(target, source[..., order])


@pytest.mark.parametrize("backend", BACKENDS)
def test_site_particle_counts_only_solids(backend):
    # particle 2 has melted and kept its site number; site 4 is spare
    phase = np.array([1, 2, 0, 1, 1, 5], dtype=np.int32)
    site = np.array([3, -1, 0, 2, 1, -1], dtype=np.int32)
    a = dict(phase=phase, site=site, site_particle=np.empty(5, np.int32))
    assert run_stage("site_particle", backend, a, {})["site_particle"].tolist() == [-1, 4, 3, 0, -1]
    empty = dict(phase=phase[:0], site=site[:0], site_particle=np.empty(2, np.int32))
    assert run_stage("site_particle", backend, empty, {})["site_particle"].tolist() == [-1, -1]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("precision", PRECISIONS)
def test_lists_by_hand(backend, precision):
    """A chain with one pair at the support, one just inside, a coincident pair, wall, inactive."""
    wide, real = PRECISIONS[precision]
    x = np.array([0.0, SUPPORT, SUPPORT, SUPPORT - 2.0**-12, 0.25, 0.25, 1.9], dtype=wide)
    position = np.stack([x, np.full(7, 0.25, wide), np.full(7, 0.25, wide)])
    phase = np.array([LIQUID, SOLID, LIQUID, LIQUID, WALL, INACTIVE, LIQUID], dtype=np.int32)
    grid = grid_of(np.dtype(real).type)
    # in cell order the inactive one goes last: x = 0, h, h, h-, wall, 1.9, inactive
    position, phase, start = sorted_by_cell(position, phase, grid)
    count, index = lists(backend, position, phase, start, grid, smoothing_of(np.dtype(real).type), 6)
    rows = [index[i, : count[i]].tolist() for i in range(7)]
    assert rows == [[3, 4], [2, 3, 4], [1, 3, 4], [0, 1, 2, 4], [], [], []]
    assert (index[0, 2:] == SENTINEL).all()  # beyond the count nothing is written


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("n", [0, 1, 7, 333, 900])
def test_lists_agree_with_brute_force(precision, n):
    wide, real = (np.dtype(t).type for t in PRECISIONS[precision])
    grid, smoothing = grid_of(real), smoothing_of(real)
    position, phase = cloud(n, n, wide) if n > 6 else (np.full((3, n), 0.3, wide), np.zeros(n, np.int32))
    position, phase, start = sorted_by_cell(position, phase, grid, "cpu")
    expected = brute(position, phase, SUPPORT)
    if n > 300:
        assert max(map(len, expected)) > 16 and min(len(r) for r, p in zip(expected, phase) if p < 2) == 0
    for backend in BACKENDS:
        count, index = lists(backend, position, phase, start, grid, smoothing, 128)
        assert count.tolist() == [len(r) for r in expected]
        assert [index[i, :c].tolist() for i, c in enumerate(count)] == expected


@pytest.mark.parametrize("backend", BACKENDS)
def test_overflow_is_counted_and_truncated(backend):
    position, phase = cloud(400, 5, np.float32)
    grid = grid_of(np.float32, counts=(1, 1, 2))
    position, phase, start = sorted_by_cell(position, phase, grid)
    expected = brute(position, phase, SUPPORT)
    count, index = lists(backend, position, phase, start, grid, smoothing_of(np.float32), 5)
    assert count.tolist() == [len(r) for r in expected] and max(count) > 5
    assert [index[i, : min(c, 5)].tolist() for i, c in enumerate(count)] == [r[:5] for r in expected]


@pytest.mark.parametrize("backend", ["cpu", "cuda"])
def test_crowded_cell(backend):
    """3000 particles at one place among others: no scratch overflows, every pair is found."""
    n = 3100
    position = np.full((3, n), 0.75, np.float32)
    position[:, 3000:] = np.random.default_rng(3).uniform(0, 1.5, (3, 100))
    phase = np.zeros(n, np.int32)
    grid = grid_of(np.float32, counts=(3, 3, 3))
    position, phase, start = sorted_by_cell(position, phase, grid, backend)
    count, index = lists(backend, position, phase, start, grid, smoothing_of(np.float32), 8)
    i = np.flatnonzero((position == 0.75).all(axis=0))
    assert i.size == 3000 and (count[i] == count[i[0]]).all() and count[i[0]] >= 2999
    assert (np.diff(index[i], axis=1) > 0).all()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("wide", ["f4", "f8"])
def test_not_finite_positions(backend, wide):
    """NaN and infinite particles have no neighbours and are nobody's; the others are unharmed."""
    rng = np.random.default_rng(7)
    position = (np.round(rng.uniform(0, 1, (3, 40)) * 4096) / 4096).astype(wide)
    position[0, 5], position[1, 6], position[2, 7], position[:, 8] = np.nan, np.inf, -np.inf, np.nan
    phase = np.zeros(40, np.int32)
    grid = grid_of(np.float32, counts=(2, 2, 2))
    position, phase, start = sorted_by_cell(position, phase, grid, backend)
    count, index = lists(backend, position, phase, start, grid, smoothing_of(np.float32), 39)
    bad = ~np.isfinite(position).all(axis=0)
    finite = np.where(bad, 1e6 * np.arange(1, 41), position)
    assert bad.sum() == 4 and (count[bad] == 0).all()
    assert [index[i, :c].tolist() for i, c in enumerate(count)] == brute(finite, phase, SUPPORT)


@pytest.mark.skipif(not AVAILABLE, reason="numba compiles for a processor without AVX-512")
@pytest.mark.parametrize("precision", PRECISIONS)
def test_packed_append_equals_portable(precision):
    """Bit for bit, on positions whose distances to the centre straddle the support by one rounding."""
    wide, real = (np.dtype(t).type for t in PRECISIONS[precision])
    rng = np.random.default_rng(11)
    m = 40 * LANES
    direction = rng.normal(size=(3, m))
    radius = SUPPORT * (1 + rng.integers(-3, 4, m) * np.finfo(real).eps)
    direction *= radius / np.linalg.norm(direction, axis=0)
    centre = rng.random(3).astype(wide)
    x, y, z = (centre[:, None] + direction).astype(wide)
    h2 = real(SUPPORT) * real(SUPPORT)
    found = [np.full(m + LANES, -1, np.int32) for _ in range(2)]
    counts = [
        f(x, y, z, m, *centre, h2, np.empty(m, np.uint8), out)
        for f, out in zip((cpu_neighbours._append_packed, cpu_neighbours._append_portable), found)
    ]
    assert counts[0] == counts[1] and 0.2 * m < counts[0] < 0.8 * m
    assert np.array_equal(found[0][: counts[0]], found[1][: counts[1]])


def test_any_number_of_threads_gives_the_same_lists():
    """Bitwise, with more threads than pieces of work have particles, too."""
    if not _compile.PARALLEL or numba.config.NUMBA_NUM_THREADS < 2:
        pytest.skip("the CPU stages are compiled without threads, or there is one thread only")
    for n in (30, 2000):
        position, phase = cloud(n, 9, np.float32)
        grid, smoothing = grid_of(np.float32), smoothing_of(np.float32)
        position, phase, start = sorted_by_cell(position, phase, grid)
        results = []
        for threads in (1, numba.config.NUMBA_NUM_THREADS):
            numba.set_num_threads(threads)
            results.append(lists("cpu", position, phase, start, grid, smoothing, 64))
        assert np.array_equal(results[0][0], results[1][0]) and np.array_equal(results[0][1], results[1][1])


def test_portable_append_drives_the_same_lists(monkeypatch):
    """The stage built on the portable loop returns what the stage returns."""
    position, phase = cloud(500, 8, np.float32)
    grid, smoothing = grid_of(np.float32), smoothing_of(np.float32)
    position, phase, start = sorted_by_cell(position, phase, grid)
    expected = lists("cpu", position, phase, start, grid, smoothing, 128)
    search = cpu_neighbours._search.py_func
    other = type(search)(
        search.__code__, {**search.__globals__, "_append": cpu_neighbours._append_portable}, "search_portable")
    count, index = np.full(500, SENTINEL, np.int32), np.full((500, 128), SENTINEL, np.int32)
    _compile.njit(error_model="numpy")(other)(
        position, phase, start, grid, smoothing, count, index, 0, start.size - 2)
    assert np.array_equal(np.where(phase == INACTIVE, 0, count), expected[0])
    assert np.array_equal(index, expected[1])
