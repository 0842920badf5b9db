"""Air ghost particles: candidates, thinning, list; false volume and completed density."""

import numba
import numpy as np
import pytest
from ghost_cases import BACKENDS, LIQUID, WALL, arrays, in_room, lattice, seeded, tuples
from scipy.spatial import cKDTree

from melt.check.compare import run_stage
from melt.reference._ghosts import positions

everywhere = pytest.mark.parametrize("backend", BACKENDS)
W0, W1, F1 = 20.3718327158, 8.6376570716, 391.139188143  # cubic spline, h = 0.5: W(0), W(0.2), -W'(0.2)/0.2


def small(counts=(3, 3, 3), lengths=(0, 0, 0), **choice):
    """Cells of 1 m with four points along an edge, without jitter, h = 1 m."""
    return tuples(
        np.float64, counts, edge=1.0, support=1.0, lengths=lengths, **{**dict(across=4, jitter=0.0, distance=0.4), **choice}
    )


@everywhere
def test_candidates_of_one_node(backend):
    params = small()
    a = arrays([[1.5, 1.5, 1.5]], LIQUID, params, volume=0.1)
    state = run_stage("ghost_candidates", backend, a, params)["ghost_state"]
    # points are odd multiples of 1/8 m away: of squares 11 to 59 of 64 there are 24 + 24 + 32 + 48 + 24 + 48 + 72
    assert (state == 1).sum() == 272 and (state == 0).sum() == 27 * 64 - 272
    # a wall 1 m along x: only the four points (7, +-1, +-1)/8 m from the node are within 0.4 m of it
    a = arrays([[1.5, 1.5, 1.5], [2.5, 1.5, 1.5]], [LIQUID, WALL], params, volume=0.1)
    state = run_stage("ghost_candidates", backend, a, params)["ghost_state"]
    assert (state == 1).sum() == 268


@everywhere
def test_who_is_no_node_has_no_candidates(backend):
    params = small()
    for phase, volume in ((WALL, 1.0), (LIQUID, 0.0), (1, 1.0), (7, 1.0)):
        a = arrays([[1.5, 1.5, 1.5]], phase, params, volume=volume)
        assert not run_stage("ghost_candidates", backend, a, params)["ghost_state"].any()
    a = arrays([[1.5, 1.5, 1.5]], LIQUID, params, volume=100.0)  # it fills all around it but the rim
    assert 0 < run_stage("ghost_candidates", backend, a, params)["ghost_state"].sum() < 272
    a = arrays(np.zeros((0, 3)), LIQUID, params)
    assert seeded(a, params, backend).size == 0


@everywhere
def test_thinning_by_hand(backend):
    params = small((2, 1, 1))
    a = arrays(np.zeros((0, 3)), LIQUID, params)
    # in a row along x, a quarter of a metre apart: the last two of cell 0, the first two of cell 1
    a["ghost_state"][[2, 3, 64, 65]] = 1
    state = run_stage("ghost_thin", backend, a, params)["ghost_state"]
    # cell 0 is first, and keeps one of its two; the other is within 0.4 m of it
    assert sorted(state[[2, 3]]) == [2, 3]
    if state[3] == 2:
        assert state[64] == 3 and state[65] == 2
    else:
        assert sorted(state[[64, 65]]) == [2, 3]
    assert (state != 0).sum() == 4


@everywhere
@pytest.mark.parametrize("cells", [2, 3, 4, 5])
def test_thinning_sees_across_the_seam(backend, cells):
    last = 64 * (cells - 1) + 3
    for length, expected in ((float(cells), 3), (0.0, 2), (cells + 0.5, 2), (cells + 0.1, 3)):
        params = small((cells, 1, 1), (length, 0, 0))
        a = arrays(np.zeros((0, 3)), LIQUID, params)
        a["ghost_state"][[0, last]] = 1
        state = run_stage("ghost_thin", backend, a, params)["ghost_state"]
        assert state[0] == 2 and state[last] == expected, length


@everywhere
def test_list_and_places(backend):
    params = small((2, 1, 2), jitter=0.0)
    a = arrays(np.zeros((0, 3)), LIQUID, params, room=3)
    a["ghost_state"][[64 + 1 + 4 * (2 + 4 * 3), 192, 255]] = 2
    a["ghost_state"][[0, 70]] = 1, 3
    a.update(run_stage("ghost_list", backend, a, params))
    assert a["ghost_start"].tolist() == [0, 0, 1, 1, 3, 3]
    x = run_stage("ghost_place", backend, a, params)["ghost_position"].T
    assert x == pytest.approx(np.array([[1.375, 0.625, 0.875], [1.125, 0.125, 1.125], [1.875, 0.875, 1.875]]))
    a["ghost_position"] = np.full((3, 2), 7.0)  # too little room: what fits
    assert run_stage("ghost_place", backend, a, params)["ghost_position"].T == pytest.approx(x[:2])


def _by_hand(ghosts, x=((0.2, 0.0, 0.0), (0.0, 0.2, 0.0)), phase=(LIQUID, WALL)):
    params = tuples(np.float64, (2, 2, 2), edge=0.5, support=0.5, origin=(-0.5, -0.5, -0.5))
    a = arrays(x, list(phase), params, room=4)
    a["ghost_position"][:, : len(ghosts)] = np.array(ghosts, dtype=float).reshape(-1, 3).T
    cell = [int(np.dot(np.array(g) >= 0, (1, 2, 4))) for g in ghosts]
    a["ghost_start"][:] = np.searchsorted(cell, np.arange(10))
    return a, params


@everywhere
def test_false_volume_by_hand(backend):
    a, params = _by_hand([(0, 0, -0.2), (0, 0, 0)])
    V = run_stage("ghost_volume", backend, a, params)["ghost_volume"]
    # itself, node, wall, ghost
    assert V[1] == pytest.approx(1 / (W0 + 3 * W1), rel=1e-9)
    a["volume"][:] = 0.0  # without mass it is none
    V = run_stage("ghost_volume", backend, a, params)["ghost_volume"]
    assert V[1] == pytest.approx(1 / (W0 + 2 * W1), rel=1e-9)


@everywhere
def test_completed_density_by_hand(backend):
    a, params = _by_hand([(0, 0, 0)], x=((0.2, 0, 0), (0, 0.2, 0), (0, 0, 0.2), (0, -0.2, 0)), phase=(LIQUID,) * 4)
    params["poisson"] = params["poisson"]._replace(floor=np.float64(0.01))
    a["density_ratio"] = np.array([0.7, 0.9, 1.1, 0.7])
    a["dfsph_factor"] = np.array([1.0, 1.0, 1.0, 0.0])
    a["ghost_volume"][0] = 0.02
    out = run_stage("ghost_complete", backend, a, params)
    assert out["completed_ratio"] == pytest.approx([0.7 + 0.02 * W1, 1.0, 1.1, 0.7], rel=1e-9)
    assert out["ghost_laplacian"] == pytest.approx([0.02 * F1 * 0.8] * 3 + [0.0], rel=1e-9)


def test_no_ghost_is_too_near_and_no_place_is_left():
    rng = np.random.default_rng(2)
    blob = lattice((9, 9, 9), 0.2, rng) - 4.5
    blob = blob[((blob**2).sum(axis=1) < 18) & (((blob - (2, 0, 0)) ** 2).sum(axis=1) > 2.0)]  # a hole in it
    wall = lattice((12, 12, 2), 0.0, rng) - (6, 6, 7)
    x = np.concatenate([blob, wall])
    a, params = in_room(x, np.repeat([LIQUID, WALL], [len(blob), len(wall)]))
    a.update(run_stage("ghost_candidates", "cpu", a, params))
    candidates = positions(np.flatnonzero(a["ghost_state"] == 1), params["grid"], params["ghosts"]).T
    ghosts = seeded(a, params)
    assert 200 < len(ghosts) < len(candidates)
    gap, _ = cKDTree(x).query(ghosts)
    assert gap.min() >= 0.85 - 1e-9 and gap.max() < 2.4
    tree = cKDTree(ghosts)
    # compared in 1/128 of the pitch, rounded up
    assert tree.query(ghosts, k=2)[0][:, 1].min() >= 0.85 - 1e-9
    assert tree.query(candidates)[0].max() < 0.85 + 0.01
    numba.set_num_threads(1)
    again = seeded(dict(a), params)
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    assert np.array_equal(ghosts, again)


@pytest.mark.parametrize("jitter", [0.0, 0.05, 0.2])
def test_completed_density_at_a_free_surface(jitter):
    x = lattice((14, 14, 7), jitter, np.random.default_rng(3))
    a, params = in_room(x, LIQUID)
    x = a["position"].T
    d = cKDTree(x).sparse_distance_matrix(cKDTree(x), 2.4).toarray()
    q = np.where((d > 0) | np.eye(len(x), dtype=bool), d / 2.4, 1.0)
    W = 8 / (np.pi * 2.4**3) * np.where(q < 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * (1 - q) ** 3)
    a["density_ratio"] = W.sum(axis=1)
    seeded(a, params)
    completed = run_stage("ghost_complete", "cpu", a, params)["completed_ratio"]
    middle = (np.abs(x[:, :2] - 7) < 4).all(axis=1)
    top, inside = middle & (x[:, 2] > 6), middle & (np.abs(x[:, 2] - 3.5) < 1)
    assert 0.73 < a["density_ratio"][top].mean() < 0.86  # spec 2.8
    assert 0.95 < completed[top].mean() <= 1.0
    assert (completed <= np.maximum(a["density_ratio"], 1.0) + 1e-12).all()
    assert completed[inside] == pytest.approx(a["density_ratio"][inside], abs=0.01)


@everywhere
def test_a_filled_periodic_box_has_none_and_a_hole_in_it_some(backend):
    x = lattice((6, 6, 6), 0.0, np.random.default_rng(1))
    params = tuples(np.float64, (2, 2, 2), edge=3.0, support=2.4, lengths=(6, 6, 6), across=6)
    assert len(seeded(arrays(x, LIQUID, params, room=500), params, backend)) == 0
    hole = x[((x - np.array([6.0, 0.0, 3.0]) + 3) % 6 - 3 != 0).any(axis=1)]
    d = np.abs((hole - np.array([6.0, 0.0, 3.0]) + 3) % 6 - 3)
    hole = hole[(d**2).sum(axis=1) > 2.0**2]  # around an edge of the box
    ghosts = seeded(arrays(hole, LIQUID, params, room=500), params, backend)
    assert len(ghosts) >= 5
    assert ((np.abs((ghosts - np.array([6.0, 0.0, 3.0]) + 3) % 6 - 3) ** 2).sum(axis=1) < 2.0**2).all()


@everywhere
def test_ghosts_stay_in_the_plane(backend):
    x = lattice((12, 1, 8), 0.05, np.random.default_rng(4))
    x[:, 1] = 0.5
    params = tuples(
        np.float64, (8, 1, 6), origin=(-3, -0.7, -3), flat=1, plane=0.5, distance=0.8, volume=1.0
    )
    a = arrays(x, LIQUID, params)
    ghosts = seeded(a, params, backend)
    assert len(ghosts) > 60 and (ghosts[:, 1] == 0.5).all()
    gap, _ = cKDTree(x).query(ghosts)
    assert gap.min() >= 0.8 - 1e-9 and cKDTree(ghosts).query(ghosts, k=2)[0][:, 1].min() >= 0.8 - 1e-9
    x = a["position"].T
    out = run_stage("ghost_complete", backend, a, params)
    surface = (x[:, 2] > 7) & (np.abs(x[:, 0] - 6) < 4)
    assert (out["ghost_laplacian"][surface] > 0).all()
    assert (out["ghost_laplacian"][(np.abs(x - (6, 0.5, 4)) < 1).all(axis=1)] == 0).all()
