"""Start of water columns: volumes, evenness, determinism, confinement; depth as a sum; calibration."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from terrain_files import terrain

from melt.errors import GeometryError, InputError
from melt.flood.pools import flow_of
from melt.geometry.barriers import SIDES, rectangle_walls
from melt.geometry.calibration import MOST, calibrate, measured_bias
from melt.geometry.columns import LAYOUTS, place
from melt.geometry.depth_sums import depth_of, lattice_bias, weight
from melt.geometry.pools import region_of, without
from melt.geometry.raster import Raster, hilbert
from melt.scene.flood_bodies import FloodObstacle, Pool

RATIO = 2.66
EVEN = ("equal_mass", "equal_area")


def flat(x, y):
    return np.ones_like(x)


def bowl(x, y):
    return 2 * (1 - (x**2 + y**2) / 400)


BOWL_VOLUME = np.pi * 400  # 2 m deep in the middle, 20 m in radius
CASES = {"flat": (flat, (-15, -15), (15, 15), 900.0, 13.0), "bowl": (bowl, (-22, -22), (22, 22), BOWL_VOLUME, 14.0)}


def away(x, length):
    """Columns farther from the rim than a support."""
    return np.hypot(*x) < length


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("case", CASES)
def test_volume_is_that_of_the_water(layout, case):
    depth, lower, upper, volume, _ = CASES[case]
    x, V = place(depth, lower, upper, 1.0, layout=layout, reference_depth=1.0)
    assert x.shape == (2, V.size) and x.dtype == V.dtype == np.float64
    assert V.sum() == pytest.approx(Raster(depth, lower, upper, 1.0).volume.sum(), rel=1e-13)
    assert V.sum() == pytest.approx(volume, rel=1e-4)
    assert (V > 0).all()


def test_equal_mass_columns_are_equal_and_of_the_size_asked_for():
    _, V = place(bowl, (-22, -22), (22, 22), 0.8, reference_depth=2.0)
    assert np.ptp(V) == 0 and V[0] == pytest.approx(0.8**2 * 2.0, rel=1e-3)


@pytest.mark.parametrize("layout", EVEN)
def test_equal_arguments_give_equal_columns_and_other_seeds_others(layout):
    one, two, other = (place(bowl, (-9, -9), (9, 9), 1.0, layout=layout, seed=s) for s in (3, 3, 4))
    assert (one[0] == two[0]).all() and (one[1] == two[1]).all()
    assert one[0].shape != other[0].shape or (one[0] != other[0]).any()


@pytest.mark.parametrize("layout", EVEN)
@pytest.mark.parametrize("case", CASES)
def test_columns_are_even(layout, case):
    depth, lower, upper, _, inner = CASES[case]
    x, V = place(depth, lower, upper, 1.0, layout=layout, reference_depth=1.0)
    own = np.sqrt(V / depth(*x))  # spacing that belongs to the depth
    nearest = cKDTree(x.T).query(x.T, k=2)[0][:, 1] / own
    some = away(x, inner)
    assert nearest[some].min() > 0.65 and nearest[some].mean() > 0.88
    error = depth_of(x, V, RATIO, (0.1, 50.0))[0][some] / depth(*x[:, some]) - 1
    assert error.std() < 0.013 and abs(error.mean()) < 0.01 and np.abs(error).max() < 0.06


def test_relaxation_is_what_evens_out():
    errors = []
    for sweeps in (0, 10, 30):
        x, V = place(bowl, (-22, -22), (22, 22), 1.0, reference_depth=1.0, relax=sweeps)
        some = away(x, 14.0)
        errors.append((depth_of(x, V, RATIO, (0.1, 50.0))[0] / bowl(*x) - 1)[some].std())
    assert errors[0] > 0.1 and errors[1] < 0.2 * errors[0] and errors[2] < 0.7 * errors[1]


@pytest.mark.parametrize("layout", EVEN)
def test_columns_form_no_rows_along_the_axes(layout):
    """The structure factor at the wave numbers of a lattice is far from its number of points."""
    x, _ = place(flat, (0, 0), (30, 30), 1.0, layout=layout, reference_depth=1.0)
    for axis in (0, 1):
        for length in (np.sqrt(0.75), 1.0, 1.0746):
            assert abs(np.exp(2j * np.pi * x[axis] / length).mean()) < 0.2
    lattice, _ = place(flat, (0, 0), (30, 30), 1.0, layout="lattice")
    assert abs(np.exp(2j * np.pi * lattice[0]).mean()) > 0.99


@pytest.mark.parametrize("layout", LAYOUTS)
def test_columns_stay_in_the_water_and_the_region(layout):
    def ring(x, y):
        return (np.hypot(x, y) < 9) & (np.hypot(x - 3, y) > 2)

    x, V = place(lambda x, y: bowl(x, y) - 1.7, (-12, -12), (12, 12), 0.5, layout=layout, region=ring)
    assert ring(*x).all() and (bowl(*x) > 1.7).all()
    assert V.size > 100


@pytest.mark.parametrize("layout", EVEN)
def test_columns_along_a_wall_stand_half_a_spacing_off(layout):
    x, _ = place(flat, (0, 0), (20, 20), 1.0, layout=layout, reference_depth=1.0)
    gap = np.minimum(x, 20 - x).min(axis=0)
    assert gap.min() > 0.15 and gap[gap < 0.75].mean() == pytest.approx(0.45, abs=0.1)


@pytest.mark.parametrize("depth", [0.3, 7.0])
def test_one_column_of_water_and_less(depth):
    x, V = place(lambda x, y: np.full_like(x, depth), (0, 0), (0.4, 0.4), 1.0, reference_depth=1.0)
    assert x.shape[1] == V.size >= 1 and V.sum() == pytest.approx(0.16 * depth)


def test_bad_requests_are_refused():
    with pytest.raises(InputError, match="layout"):
        place(flat, (0, 0), (1, 1), 0.1, layout="random")
    with pytest.raises(InputError, match="upper above lower"):
        place(flat, (0, 0), (0, 1), 0.1)
    with pytest.raises(InputError, match="not finite"):
        place(lambda x, y: np.where(x > 0.5, np.nan, 1.0), (0, 0), (1, 1), 0.1)
    with pytest.raises(GeometryError, match="no water"):
        place(lambda x, y: -np.ones_like(x), (0, 0), (1, 1), 0.1)
    with pytest.raises(GeometryError, match="columns"):
        place(flat, (0, 0), (1e6, 1e6), 0.1)


def test_hilbert_curve_visits_every_cell_by_single_steps():
    i, j = (a.ravel() for a in np.meshgrid(np.arange(16), np.arange(16)))
    order = np.argsort(hilbert(i, j))
    assert (np.abs(np.diff(i[order])) + np.abs(np.diff(j[order])) == 1).all()


def test_kernel_has_integral_one_and_known_lattice_sums():
    r = (np.arange(4000) + 0.5) / 4000 * 2.66
    assert np.sum(2 * np.pi * r * weight(r, 2.66)) * 2.66 / 4000 == pytest.approx(1.0, abs=1e-6)
    assert lattice_bias(2.66) == pytest.approx(5.1e-4, abs=1e-5)
    assert lattice_bias(2.66, "hexagonal") == pytest.approx(4.7e-3, abs=1e-5)


def test_depth_of_a_lattice_is_exact_and_of_one_column_is_its_own_share():
    x, V = place(flat, (0, 0), (20, 20), 1.0, layout="lattice")
    depth, support = depth_of(x, V, RATIO, (0.5, 13.3))
    inner = np.abs(x - 10).max(axis=0) < 6
    assert np.abs(depth[inner] - 1).max() < 1e-13 and np.abs(support[inner] - RATIO).max() < 1e-12
    # without a neighbour no depth agrees with its support, which grows to its limit. Spec section 2, E9
    depth, support = depth_of(np.zeros((2, 1)), np.ones(1), RATIO, (0.5, 13.3))
    assert support[0] == 13.3 and depth[0] == pytest.approx(0.0103, abs=1e-4)


def test_depth_and_support_agree_for_any_cloud():
    random = np.random.default_rng(1)
    x, V = random.uniform(0, 12, (2, 200)), random.uniform(0.1, 3.0, 200)
    depth, support = depth_of(x, V, RATIO, (0.05, 40.0), bias=0.0)
    r = np.hypot(*(x[:, :, None] - x[:, None, :]))
    assert depth == pytest.approx((V * weight(r, support[:, None])).sum(axis=1), rel=1e-10)
    assert support == pytest.approx(RATIO * np.sqrt(V / depth), rel=1e-10)


def test_calibration_reaches_the_depths_to_a_millionth():
    x, V = place(flat, (0, 0), (20, 20), 1.0, reference_depth=1.0)
    walls = rectangle_walls((0, 0), (20, 20), SIDES, 0.5, 4.0)
    bias = measured_bias(x, V, np.ones(V.size), RATIO, walls)
    W, report = calibrate(x, V, np.ones(V.size), RATIO, walls, sweeps=5000, bias=bias)
    assert report.error <= 1e-6 < 0.01 < report.before and report.bound == 0
    assert abs(report.change) < 2e-3 and W.sum() == pytest.approx(V.sum() * (1 + report.change))
    depth, support = depth_of(x, W, RATIO, (0.3, 13.3), walls, bias=bias, reference=V)
    assert np.abs(depth - 1).max() < 1e-5 and support == pytest.approx(report.support, rel=1e-5)


def test_a_few_sweeps_take_most_of_the_error():
    x, V = place(bowl, (-22, -22), (22, 22), 1.0, reference_depth=1.0)
    _, report = calibrate(x, V, bowl(*x), RATIO, sweeps=20)
    assert report.sweeps == 20 and report.error < 0.35 * report.before and report.rms < 3e-3
    assert report.largest < 0.3


def test_calibration_keeps_columns_that_cannot_reach_their_depth():
    """Without walls the rim of a slab lacks half of its neighbours."""
    x, V = place(flat, (0, 0), (12, 12), 1.0, reference_depth=1.0)
    W, report = calibrate(x, V, np.ones(V.size), RATIO)
    assert report.bound > 0 and report.error > 1e-6
    assert (W >= V / MOST).all() and (W <= V * MOST).all()


def test_pools_give_depth_above_the_bed_and_velocity():
    grid = terrain(shape="plane", lower=[0, 0], upper=[40, 40], cell="1 m", parameters={"slope": -0.1})
    x = grid.local(np.array([[4.5, 8.0, 30.0], [20.0, 20.0, 20.0]]))
    d, u, v = flow_of(Pool(stage=1.0, velocity=[2, 3]), grid, 9.81, "bspline", "pool")(*x)
    assert d == pytest.approx([0.55, 0.2, 0.0], abs=1e-5) and u.tolist() == [2] * 3 and v.tolist() == [3] * 3
    assert flow_of(Pool(depth="50 cm"), grid, 9.81, "bspline", "pool")(*x)[0].tolist() == [0.5] * 3


def test_pools_give_a_region():
    x = np.array([0.5, 4.0, 30.0])
    for pool in (
        {"lower": [0, 0], "upper": [5, 5]},
        {"centre": [0, 0], "radius": 6},
        {"polygon": [[0, 0], [9, 0], [9, 9], [0, 9]]},
    ):
        assert region_of(Pool(depth=1, **pool))(x, x).tolist() == [True, True, False]
    assert region_of(Pool(depth=1))(x, x).all()
    tower = FloodObstacle(shape="cylinder", centre=[4, 4], radius=1)
    assert without([tower], region_of(Pool(depth=1)))(x, x).tolist() == [True, False, True]


@pytest.mark.parametrize(
    ("words", "table"),
    [
        ("exactly one", {}),
        ("exactly one", {"depth": 1, "stage": 2}),
        ("give both", {"depth": 1, "lower": [0, 0]}),
        ("one region", {"depth": 1, "lower": [0, 0], "upper": [1, 1], "centre": [0, 0], "radius": 1}),
        ("must exceed", {"depth": 1, "lower": [0, 0], "upper": [0, 1]}),
        ("extra", {"depth": 1, "colour": "blue"}),
        ("at most 2", {"depth": 1, "velocity": [0, 0, 0]}),
    ],
)
def test_pools_that_make_no_sense_are_refused(words, table):
    with pytest.raises(ValueError, match=words):
        Pool(**table)
