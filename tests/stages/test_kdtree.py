"""The left-balanced KD-tree and its lists: reference, CPU and emulated CUDA."""

import numpy as np
import pytest
from test_neighbours import (
    BACKENDS,
    INACTIVE,
    PRECISIONS,
    SUPPORT,
    brute,
    cloud,
    grid_of,
    lists,
    smoothing_of,
    sorted_by_cell,
)

from melt.check.compare import run_stage

pytestmark = pytest.mark.usefixtures("emulated")


def build(backend, position):
    n = position.shape[1]
    a = dict(position=position, tree=np.empty(n, np.int32), tree_rank=np.empty(n, np.int32))
    return run_stage("kdtree_build", backend, a, {})["tree"]


def tree_lists(backend, position, phase, tree, smoothing, capacity):
    n = phase.size
    a = dict(
        position=position, phase=phase, tree=tree, neighbour_count=np.empty(n, np.int32),
        neighbour_index=np.empty((n, capacity), np.int32),
    )
    out = run_stage("neighbours_kdtree", backend, a, {"smoothing": smoothing})
    return out["neighbour_count"], out["neighbour_index"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_tree_by_hand(backend):
    """Ten points of the plane: the third coordinate is constant, so its levels are split by index."""
    x = [10, 46, 68, 40, 25, 15, 44, 45, 62, 53]
    y = [15, 63, 21, 33, 54, 43, 58, 40, 69, 67]
    position = np.array([x, y, np.zeros(10)], dtype=np.float32)
    # level 0, by x: 10 15 25 40 44 45 | 46 | 53 62 68: 6 on the left, 3 on the right -> particle 1
    # level 1, by y: left  15(0) 33(3) 40(7) | 43(5) | 54(4) 58(6);  right 21(2) | 67(9) | 69(8)
    # level 2, z constant, by index: 0 | 3 | 7;  4 | 6 (one on the left: 4, root 6);  2;  8
    assert build(backend, position).tolist() == [1, 5, 9, 3, 6, 2, 8, 0, 7, 4]


@pytest.mark.parametrize("n", [*range(0, 20), 31, 32, 33, 127, 128, 129, 300, 1000])
def test_trees_agree_and_are_trees(n):
    rng = np.random.default_rng(n)
    position = rng.integers(0, max(n // 6, 2), (3, n)).astype(np.float32)  # many ties, coincident ones too
    trees = [build(b, position) for b in BACKENDS]
    assert np.array_equal(trees[0], trees[1]) and np.array_equal(trees[0], trees[2])
    tree = trees[0]
    assert sorted(tree) == list(range(n))
    for k in range(1, n):  # every node is on the right side of all its ancestors
        child, above = k, k
        while above > 0:
            side, above = above % 2, (above - 1) // 2
            axis = (int(above + 1).bit_length() - 1) % 3
            a = (position[axis, tree[child]], tree[child])
            b = (position[axis, tree[above]], tree[above])
            assert a < b if side == 1 else a > b


def test_presorted_and_not_finite_input():
    """Sorted, reversed, constant and organ-pipe coordinates; NaN and infinities sort last and first."""
    n = 700
    ramp = np.arange(n, dtype=float)
    position = np.stack([ramp, ramp[::-1], np.minimum(ramp, ramp[::-1])])
    for p in (position, position[[2, 0, 1]], np.zeros((3, n))):
        trees = [build(b, p) for b in BACKENDS]
        assert np.array_equal(trees[0], trees[1]) and np.array_equal(trees[0], trees[2])
    position[0, ::5], position[1, 3::7], position[2, ::11] = np.nan, np.inf, -np.inf
    trees = [build(b, position) for b in BACKENDS]
    assert np.array_equal(trees[0], trees[1]) and np.array_equal(trees[0], trees[2])
    phase = np.zeros(n, np.int32)
    expected = tree_lists("reference", position, phase, trees[0], smoothing_of(np.float64, 6.5), 64)
    assert expected[0].max() > 4
    for backend in ("cpu", "cuda"):
        got = tree_lists(backend, position, phase, trees[0], smoothing_of(np.float64, 6.5), 64)
        assert np.array_equal(got[0], expected[0]) and np.array_equal(got[1], expected[1])


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("n", [0, 1, 7, 333, 900])
def test_lists_agree_with_brute_force(precision, n):
    """In any particle order: the tree does not need the cells."""
    wide, real = (np.dtype(t).type for t in PRECISIONS[precision])
    position, phase = cloud(n, n, wide) if n > 6 else (np.full((3, n), 0.3, wide), np.zeros(n, np.int32))
    expected = brute(position, phase, SUPPORT)
    for backend in BACKENDS:
        count, index = tree_lists(backend, position, phase, build(backend, position), smoothing_of(real), 128)
        assert count.tolist() == [len(r) for r in expected]
        assert [index[i, :c].tolist() for i, c in enumerate(count)] == expected


@pytest.mark.parametrize("backend", BACKENDS)
def test_overflow_keeps_the_smallest(backend):
    position, phase = cloud(400, 5, np.float32)
    expected = brute(position, phase, SUPPORT)
    tree = build(backend, position)
    for capacity in (0, 5):
        count, index = tree_lists(backend, position, phase, tree, smoothing_of(np.float32), capacity)
        assert count.tolist() == [len(r) for r in expected] and max(count) > 5
        assert [index[i, : min(c, capacity)].tolist() for i, c in enumerate(count)] == [
            r[:capacity] for r in expected]


@pytest.mark.parametrize("backend", ["cpu", "cuda"])
@pytest.mark.parametrize("precision", PRECISIONS)
def test_same_lists_as_the_grid_at_the_last_bit(backend, precision):
    """A lattice whose (3, 4, 0) and (5, 0, 0) neighbours lie at the support, decided by rounding alone."""
    wide, real = (np.dtype(t).type for t in PRECISIONS[precision])
    lattice = np.stack(np.meshgrid(*[np.arange(13)] * 3, indexing="ij")).reshape(3, -1)
    position = (lattice * 0.1 + 0.037).astype(wide)
    phase = np.zeros(position.shape[1], np.int32)
    phase[::50] = INACTIVE
    grid, smoothing = grid_of(real, counts=(3, 3, 3), cell=0.5001), smoothing_of(real, 0.5)
    position, phase, start = sorted_by_cell(position, phase, grid, backend)
    by_grid = lists(backend, position, phase, start, grid, smoothing, 600)
    by_tree = tree_lists(backend, position, phase, build(backend, position), smoothing, 600)
    assert np.array_equal(by_grid[0], by_tree[0]) and np.array_equal(by_grid[1], by_tree[1])
    i = int(np.argmax(by_grid[0]))
    assert 400 < by_grid[0][i] < 600
