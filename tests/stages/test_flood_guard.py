"""Sides of the basin, ground that water may not enter, and the water that is lost there or into the ground."""

import numpy as np
import pytest
from flood_motion_cases import AIRBORNE, BASIN, INACTIVE, LIQUID, TERRAIN, arrays, run
from liquid_cases import BACKENDS, REALS, everywhere

SKIN = BASIN["skin"]
OPEN = dict(west=1, east=1, south=1, north=1)
WALLS = dict(west=0, east=0, south=0, north=0)


def nodes():
    """Return x and y of the nodes, each (ny, nx)."""
    return np.meshgrid(np.arange(TERRAIN["nx"]), np.arange(TERRAIN["ny"]), indexing="xy")


def guard(backend, a, **changes):
    out = run("flood_guard", backend, a, **changes)
    return out["left_volume"].sum(axis=1)


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_open_sides_let_columns_go_and_book_them(backend, precision):
    """East and north are open: what is beyond has left, with its volume, where it was."""
    x = [[6.01, 1, 0], [1, 5.5, 0], [6.0, 5.0, 0], [7, 1, 0], [8, 2, 0]]
    a = arrays(x, [LIQUID, AIRBORNE, LIQUID, INACTIVE, LIQUID], precision, rest_volume=[1, 2, 4, 8, 16])
    before = a["position"].copy()
    left = guard(backend, a)
    assert a["phase"].tolist() == [INACTIVE, INACTIVE, LIQUID, INACTIVE, INACTIVE]
    assert left.tolist() == [19, 0, 0, 0] and a["left_volume"].dtype == np.float64
    assert (a["position"] == before).all()


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_walls_keep_columns_a_skin_inside_and_take_the_outward_velocity(backend, precision):
    x = [[-3.0, 1, 7], [0.0625, 1, 7], [1, 0.125, 7], [1, -1, 7], [1, 5, 7], [9, -2, 7]]
    v = np.tile([[-1.0], [-2.0], [-3.0]], 6)
    v[:2, 1], v[:2, 4:] = 1.0, 2.0
    a = arrays(x, [LIQUID, LIQUID, LIQUID, AIRBORNE, LIQUID, LIQUID], precision, velocity=v)
    assert (guard(backend, a, **WALLS) == 0).all()
    want = [[SKIN, 1], [SKIN, 1], [1, SKIN], [1, SKIN], [1, 5 - SKIN], [6 - SKIN, SKIN]]
    assert (a["position"].T[:, :2] == want).all() and (a["position"][2] == 7).all()
    # moving inwards or along a wall is kept, and so is a fall
    assert a["velocity"].T.tolist() == [[0, -2, -3], [1, 1, -3], [-1, -2, -3], [-1, 0, -3], [2, 0, -3], [0, 2, -3]]


@everywhere
def test_a_place_that_is_not_finite_is_left_for_the_check_that_reports_it(backend):
    x = np.array([[np.nan, 1, 0], [1, np.inf, 0], [-np.inf, 1, 0]])
    a = arrays(x, velocity=np.ones((3, 3)))
    assert (guard(backend, a, **OPEN, guard=1) == 0).all()
    assert np.array_equal(a["position"].T, x, equal_nan=True) and (a["phase"] == LIQUID).all() and (a["velocity"] == 1).all()


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_blocked_ground_pushes_along_its_normal(backend, precision):
    """A house whose edge is the line through (2, 0) and (0, 2): bilinear distance is exact, its normal (1, 1)/sqrt 2."""
    x, y = nodes()
    n = np.sqrt(0.5)
    a = arrays(
        [[1, 1, 0], [0.75, 0.75, 0], [2, 0.5, 0], [1.0625, 1.0625, 0]], [LIQUID, AIRBORNE, LIQUID, LIQUID], precision,
        terrain_wall=((x + y - 2) * n).ravel(), velocity=np.array([[-1, 0, 5.0], [-1, -1, 5.0], [-1, -1, 5.0], [1, 2, 5.0]]).T,
    )
    assert (guard(backend, a, guard=1, **OPEN) == 0).all()
    rel = 1e-12 if precision == "double" else 3e-7
    shift = SKIN * n
    assert a["position"].T[:, :2] == pytest.approx(np.array([[1 + shift] * 2, [1 + shift] * 2, [2, 0.5], [1 + shift] * 2]), rel=rel)
    # the inward part goes, along the edge stays; what is far enough, and what moves away, keeps all
    want = np.array([[-0.5, 0.5, 5], [0, 0, 5], [-1, -1, 5], [1, 2, 5]])
    assert a["velocity"].T == pytest.approx(want, rel=rel, abs=1e-12 if precision == "double" else 1e-6)


@everywhere
def test_a_corner_takes_two_pushes(backend):
    """Two houses meet in an inner corner at (2, 2), which bilinear distance rounds: water ends up beyond both."""
    x, y = nodes()
    a = arrays([[1.75, 1.6, 0]], terrain_wall=np.minimum(x - 2, y - 2).ravel(), velocity=[[-1.0], [-2.0], [0]])
    guard(backend, a, guard=1, **OPEN)
    assert (a["position"][:2] >= 2 + SKIN - 0.0101).all() and (a["position"][:2] <= 2.35).all()
    assert a["phase"][0] == LIQUID and (a["velocity"][:2] > -0.3).all()


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_what_cannot_be_pushed_out_is_taken_away(backend, precision):
    """Deeper than two node distances, or in a pit of the distance that has no slope."""
    x, _ = nodes()
    a = arrays([[1.5, 1, 0], [3.5, 1, 0], [5.5, 1, 0]], LIQUID, precision, rest_volume=[2, 4, 8], terrain_wall=(x - 4.0).ravel())
    assert guard(backend, a, guard=1, **OPEN).tolist() == [0, 2, 0, 0]
    assert a["phase"].tolist() == [INACTIVE, LIQUID, LIQUID]
    assert a["position"][0] == pytest.approx([1.5, 4 + SKIN, 5.5], rel=1e-6)
    a = arrays([[1.5, 1, 0]], LIQUID, precision, rest_volume=[2], terrain_wall=np.full(x.size, -0.5))
    assert guard(backend, a, guard=1, **OPEN).tolist() == [0, 2, 0, 0] and a["phase"].tolist() == [INACTIVE]


@everywhere
def test_no_ground_is_blocked_unless_the_scene_says_so(backend):
    a = arrays([[1.5, 1, 0]], terrain_wall=np.zeros(0))
    assert (guard(backend, a, guard=0) == 0).all() and a["phase"].tolist() == [LIQUID]
    a = arrays([[1.5, 1, 0]], terrain_wall=np.full(TERRAIN["nx"] * TERRAIN["ny"], 1e30))  # far from everything
    assert (guard(backend, a, guard=1) == 0).all() and a["position"][:2, 0].tolist() == [1.5, 1]


@everywhere
def test_a_push_does_not_lead_out_of_the_basin(backend):
    """The house covers all but a strip at the western wall, narrower than the skin: the wall has the last word."""
    x, _ = nodes()
    a = arrays([[0.5, 1, 0]], terrain_wall=(0.0625 - x).ravel())
    guard(backend, a, guard=1)
    assert a["position"][0, 0] == SKIN


@everywhere
def test_each_sum_has_its_own_share_of_the_columns(backend):
    n = 130
    a = arrays(np.column_stack([np.full(n, 9.0), np.ones(n), np.zeros(n)]), rest_volume=np.arange(n))
    guard(backend, a)
    cuts = [p * n // 64 for p in range(65)]
    assert (a["left_volume"][0] == [np.arange(n)[i:j].sum() for i, j in zip(cuts, cuts[1:])]).all()
    assert (a["left_volume"][1:] == 0).all()


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_seepage_by_hand(backend, precision):
    """0.25 m/s for 0.5 s is a layer of 0.125 m: a column of area V/d loses V/(8 d); what is less than 0.25 m^3 goes."""
    V, d = np.array([1.0, 1.0, 0.5, 1.0, 1.0]), np.array([1.0, 0.5, 0.25, 0.0625, 0.5])
    phase = [LIQUID, LIQUID, LIQUID, LIQUID, AIRBORNE]
    a = arrays(np.zeros((5, 3)), phase, precision, rest_volume=V, mass=1000 * V, depth=d)
    a["left_volume"][:2] = 3.0
    run("infiltrate", backend, a, rate=0.25, thinnest=0.3, dt=0.5)
    assert a["rest_volume"].tolist() == [0.875, 0.75, 0.25, 0, 1] and a["mass"].tolist() == [875, 750, 250, 0, 1000]
    assert a["phase"].tolist() == [LIQUID, LIQUID, INACTIVE, INACTIVE, AIRBORNE]
    assert a["left_volume"].sum(axis=1).tolist() == [192, 192, 0.125 + 0.25 + 0.25 + 1, 0.25]


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_the_balance_of_seepage_holds_to_the_last_bit_of_a_double(backend, precision):
    rng = np.random.default_rng(3)
    V = rng.uniform(0.2, 3, 500)
    a = arrays(np.zeros((500, 3)), LIQUID, precision, rest_volume=V, depth=rng.uniform(0.01, 2, 500))
    total = booked = a["rest_volume"].sum(dtype=float)
    for _ in range(20):
        run("infiltrate", backend, a, rate=1e-4, thinnest=0.25, dt=1.0)
        booked -= a["left_volume"][2:].sum()
    left = a["rest_volume"][a["phase"] == LIQUID].sum(dtype=float)
    assert left == pytest.approx(booked, abs=1e-12 * total)
    assert (a["phase"] == INACTIVE).sum() > 3 and (a["phase"] == LIQUID).sum() > 300


@everywhere
def test_nan_does_not_seep_away(backend):
    a = arrays(np.zeros((2, 3)), rest_volume=[np.nan, 1.0], depth=[1.0, np.nan])
    run("infiltrate", backend, a, rate=0.1, thinnest=0.2, dt=0.5)
    assert np.isnan(a["rest_volume"]).all() and (a["phase"] == LIQUID).all()


@pytest.mark.parametrize("backend", BACKENDS)
def test_nothing_is_fine(backend):
    a = arrays(np.zeros((0, 3)))
    assert (guard(backend, a) == 0).all()
    run("infiltrate", backend, a, rate=0.1, thinnest=0.2, dt=0.5)
    assert (a["left_volume"] == 0).all()
