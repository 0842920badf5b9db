"""Neighbours of columns whose supports differ, and of walls, against brute force (flood 1, 1.5, E14)."""

import types

import numpy as np
import pytest
from flood_cases import AIRBORNE, FLOOD, GRID, INACTIVE, LIQUID, arrays, near, run
from liquid_cases import BACKENDS, REALS, everywhere

from melt import _compile
from melt.cpu import flood_neighbours as cpu
from melt.params import Flood, Grid, make


def rows(a, name="neighbour"):
    return [a[f"{name}_index"][i, :n].tolist() for i, n in enumerate(a[f"{name}_count"])]


def search(backend, a, rings=12, **changes):
    """Supports of cells, their reach, lists; from inputs with poisoned outputs."""
    run("cell_support", backend, a)
    run("cell_reach", backend, a, rings=rings, empty=0, **changes)
    return run("flood_neighbours", backend, a, **changes)


def scene(kind, seed=0, n=400):
    """Columns and a grid: ``deep`` (h a third of a cell), ``thin`` (h = 5 cells), ``mixed``, ``outside`` (most beyond the grid)."""
    rng = np.random.default_rng(seed)
    grid = dict(GRID, nx=16, ny=12)
    size = np.array([16.0, 12.0])
    if kind == "deep":
        return rng.uniform(0, 1, (n, 2)) * 3 + 6, rng.uniform(0.25, 0.4, n), grid
    if kind == "thin":
        return rng.uniform(0, 1, (n // 8, 2)) * size, rng.uniform(4, 6, n // 8), grid
    if kind == "outside":
        return rng.uniform(-1, 2, (n, 2)) * size, rng.uniform(0.5, 4, n), grid
    x = rng.uniform(0, 1, (n, 2)) * size
    return x, 0.3 + 3.5 * rng.random(n) ** 6 + 0.1 * x[:, 0], grid


@everywhere
@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("kind", ("deep", "thin", "mixed", "outside"))
def test_lists_equal_brute_force(backend, precision, kind):
    """All j with r < growth max(h_i, h_j), ascending; in float32 too, of positions as they are rounded."""
    for seed in range(2):
        x, h, grid = scene(kind, seed)
        phase = np.random.default_rng(seed + 9).choice([LIQUID, AIRBORNE, INACTIVE], len(x), p=[0.85, 0.1, 0.05])
        x, h = (np.float32(v).astype(float) for v in (x, h))
        a = arrays(x, 1.0, h, phase, precision, grid=grid, ordered=True)
        x, h, phase = a["position"][:2].T.astype(float), a["support_radius"].astype(float), a["phase"]
        expected = near(x, h, phase)
        got = search(backend, a, **{k: grid[k] for k in ("nx", "ny")})
        off = [i for i, row in enumerate(rows(got)) if row != expected[i].tolist()]
        if off and precision != "double":  # a pair at its reach to the last bit
            for i in off:
                for j in set(rows(got)[i]) ^ set(expected[i].tolist()):
                    assert np.hypot(*(x[i] - x[j])) == pytest.approx(1.1 * max(h[i], h[j]), rel=3e-7)
        else:
            assert not off
        assert sum(map(len, expected)) > 500


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_pair_at_its_reach_is_none_and_the_larger_support_decides(backend, precision):
    """growth 1.125: at 2.25 m a support of 2 does not reach, just within it does; the other's 0.5 does not matter."""
    for gap, count in ((2.25, 0), (2.25 - 2**-16, 1)):
        a = arrays([[1, 1], [1 + gap, 1]], 1.0, [2.0, 0.5], precision=precision, ordered=True, growth=1.125)
        assert search(backend, a, growth=1.125)["neighbour_count"].tolist() == [count, count]


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_coincident_columns_are_neighbours_and_none_is_its_own(backend, precision):
    a = arrays([[1.5, 1.5]] * 3 + [[7.5, 5.5]], 1.0, 0.5, precision=precision, ordered=True)
    assert rows(search(backend, a)) == [[1, 2], [0, 2], [0, 1], []]


@everywhere
def test_falling_columns_have_a_list_and_are_in_none(backend):
    a = arrays([[1.2, 1], [1.4, 1], [1.6, 1], [1.8, 1]], 1.0, 1.0, [LIQUID, AIRBORNE, LIQUID, INACTIVE], ordered=True)
    assert rows(search(backend, a)) == [[2], [0, 2], [0], []]


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_place_or_support_that_is_no_number_is_nobodys_neighbour(backend, precision):
    x, h = np.array([[0.5, 0.5], [0.6, 0.5], [0.7, 0.5], [0.8, 0.5]]), np.ones(4)
    for bad in (np.nan, np.inf, -np.inf):
        y = x.copy()
        y[0] = bad
        a = arrays(y, 1.0, h, precision=precision, ordered=True)
        lone = int(np.flatnonzero(~np.isfinite(a["position"][0]))[0])
        found = rows(search(backend, a))
        assert found[lone] == [] and all(len(row) == 2 for i, row in enumerate(found) if i != lone)
    h[0] = np.nan
    a = arrays(x, 1.0, h, precision=precision, ordered=True)
    assert rows(search(backend, a)) == [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]
    a = arrays([[0.5, 0.5]], 1.0, np.nan, precision=precision, ordered=True)
    assert rows(search(backend, a)) == [[]]


@everywhere
@pytest.mark.parametrize("capacity", [0, 1, 5])
def test_overflow_is_counted_and_stays_in_its_row(backend, capacity):
    x = np.random.default_rng(1).uniform(1, 2, (30, 2))
    a = arrays(x, 1.0, 2.0, ordered=True, neighbour_index=np.zeros((30, capacity)))
    got = search(backend, a)
    assert (got["neighbour_count"] == 29).all()
    for i, row in enumerate(got["neighbour_index"]):
        assert row.tolist() == [j for j in range(30) if j != i][:capacity]


@everywhere
@pytest.mark.parametrize("h, ring", [(0.5, 1), (0.9, 1), (1 / 1.1 + 1e-3, 2), (2.0, 3), (4.9, 6), (0.0, 1)])
def test_reach_of_a_column_alone(backend, h, ring):
    """The outermost ring k with 1.1 h > k - 1; its own cell gets it too, and of empty cells only those that it reaches."""
    a = arrays([[4.5, 3.5]], 1.0, h, ordered=True)
    run("cell_support", backend, a)
    own = 3 * 8 + 4
    expected = np.zeros(50, int)
    expected[own] = ring
    assert (run("cell_reach", backend, a, rings=9, empty=0)["cell_reach"] == expected).all()
    c = np.arange(48)
    apart = np.maximum(abs(c % 8 - 4), abs(c // 8 - 3))
    expected[:48] = np.where((apart > 0) & (1.1 * h > apart - 1), apart, expected[:48])
    assert (run("cell_reach", backend, a, rings=9, empty=1)["cell_reach"] == expected).all()
    expected = np.minimum(expected, 2)
    expected[:48][apart > 2] = 0
    assert (run("cell_reach", backend, a, rings=2, empty=1)["cell_reach"] == expected).all()


@everywhere
def test_cell_looks_as_far_as_the_widest_column_that_sees_it(backend):
    """A narrow column three cells from a wide one looks three rings far, one five cells away only one."""
    a = arrays([[0.5, 0.5], [3.5, 0.5], [5.5, 0.5]], 1.0, [2.5, 0.5, 0.5], ordered=True)
    run("cell_support", backend, a)
    assert a["cell_support"][:6].tolist() == [2.5, 0, 0, 0.5, 0, 0.5]
    got = run("cell_reach", backend, a, rings=9, empty=0)["cell_reach"][:6].tolist()
    assert got == [3, 0, 0, 3, 0, 1]


@everywhere
def test_support_of_a_cell_leaves_out_what_is_no_number_and_who_waits(backend):
    a = arrays([[0.5, 0.5]] * 4, 1.0, [np.nan, 1.0, 2.0, 9.0], [LIQUID, LIQUID, AIRBORNE, INACTIVE], ordered=True)
    assert run("cell_support", backend, a)["cell_support"].tolist() == [2.0] + 49 * [0]


@pytest.mark.parametrize("backend", BACKENDS)
def test_no_column_at_all(backend):
    a = arrays(np.zeros((0, 2)), ordered=True)
    assert search(backend, a)["neighbour_count"].shape == (0,)
    assert (a["cell_support"] == 0).all() and (a["cell_reach"] == 0).all()
    a.update(arrays(np.zeros((0, 2)), walls=[[1, 1, 0, 1.0]]))
    assert run("wall_neighbours", backend, a)["wall_count"].shape == (0,)


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_walls_equal_brute_force(backend, precision):
    """Walls of any shape, some beyond the grid, columns of water with supports of 0.1 to 4 cells; others have no list."""
    rng = np.random.default_rng(7)
    wall = np.column_stack([rng.uniform(-1, 5, 80), rng.uniform(-1, 7, 80), np.zeros(80), np.ones(80)])
    wall[:, :2] = np.round(wall[:, :2] * 64) / 64
    x = np.round(rng.uniform(-1, 8, (200, 2)) * 64) / 64
    h = np.round(0.1 + 4 * rng.random(200) ** 3, 2)
    a = arrays(x, 1.0, h, rng.choice([LIQUID, AIRBORNE, INACTIVE], 200, p=[0.8, 0.1, 0.1]), precision, walls=wall)
    expected = rows(a, "wall")
    assert rows(run("wall_neighbours", backend, a), "wall") == expected and sum(map(len, expected)) > 300


@everywhere
def test_walls_overflow_and_scenes_without(backend):
    wall = np.column_stack([np.full((9, 2), 1.0), np.zeros(9), np.ones(9)])
    a = arrays([[1.0, 1.5], [7.5, 5.5]], 1.0, 1.0, walls=wall, wall_index=np.zeros((2, 4)))
    got = run("wall_neighbours", backend, a)
    assert got["wall_count"].tolist() == [9, 0] and got["wall_index"][0].tolist() == [0, 1, 2, 3]
    a = arrays([[1.0, 1.5]], 1.0, 1.0)
    assert run("wall_neighbours", backend, a)["wall_count"].shape == (0,)


@pytest.mark.skipif(not cpu.AVAILABLE, reason="compiled without AVX-512")
@pytest.mark.parametrize("precision", REALS)
def test_packed_loops_equal_portable(precision):
    """Also for NaN, infinity, ties, any begin and end of the range, and arrays that end with it."""
    real, wide = REALS[precision]
    rng = np.random.default_rng(3)
    flood = make(Flood, real, **dict.fromkeys(Flood._fields, 0))._replace(growth=real(1.1))
    for n in (0, 1, 15, 16, 17, 33, 100):
        x, y = (np.round(rng.uniform(0, 4, n) * 8) / 8 for _ in range(2))
        h, phase = rng.choice([0.0, 0.5, 1.0, np.nan, 3.0], n).astype(real), rng.choice([0, 0, 0, 5, 6], n).astype(np.int32)
        x[rng.random(n) < 0.1] = np.nan
        y[rng.random(n) < 0.1] = np.inf
        x, y = x.astype(wide), y.astype(wide)
        for start in range(0, n + 1, 7):
            found = []
            for f in (cpu._near_box_packed, cpu._near_box_portable):
                out = np.full(n + 48, -5, np.int32)
                count = f(x, y, h, phase, start, n, wide(1), wide(1.5), wide(2), wide(2.25), real(0.25), flood, out, 3)
                found.append(out[3:count].tolist())
            assert found[0] == found[1]
        padded = -(-n // 16) * 16
        bx, by, reach = (np.concatenate([v, np.full(padded - n, np.inf, v.dtype)]) for v in (x, y, np.nan_to_num(h)))
        found = []
        for f in (cpu._in_reach_packed, cpu._in_reach_portable):
            out, hit = np.full(padded + 16, -5, np.int32), np.zeros(padded + 16, np.uint8)
            count = f(bx, by, reach, np.arange(7, 7 + padded, dtype=np.int32), padded, wide(2), wide(2), real(0.5), hit, out)
            found.append(out[:count].tolist())
        assert found[0] == found[1] and (n < 17 or len(found[0]) > 0)


@pytest.mark.parametrize("kind", ("deep", "mixed"))
def test_portable_loops_drive_the_same_lists(kind):
    """The search built on the portable loops finds what the stage finds."""
    x, h, grid = scene(kind)
    a = arrays(x, 1.0, h, precision="single", grid=grid, ordered=True)
    expected = search("cpu", a, nx=grid["nx"], ny=grid["ny"])
    names = {**cpu._search.py_func.__globals__, "_near_box": cpu._near_box_portable, "_in_reach": cpu._in_reach_portable}
    portable = types.FunctionType(cpu._search.py_func.__code__, names, "search_portable")
    count, index = np.zeros_like(a["neighbour_count"]), np.full_like(a["neighbour_index"], -1)
    arguments = (a[k] for k in ("position", "phase", "support_radius", "cell_start", "cell_reach"))
    _compile.njit(error_model="numpy")(portable)(
        *arguments, make(Grid, np.float32, **grid), make(Flood, np.float32, **FLOOD), count, index, 0, grid["nx"] * grid["ny"],
    )
    assert (count == expected["neighbour_count"]).all()
    assert rows(dict(neighbour_count=count, neighbour_index=index)) == rows(expected)
