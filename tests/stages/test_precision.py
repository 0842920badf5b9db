"""Effect precision: eq (15), iteration keys, active lists, short lists (boiling 2.6)."""

import numpy as np
import pytest
from liquid_cases import both, everywhere
from pbf_cases import MASS, D, arrays, pbf_tuple, run

from melt.position_based import surface_height


@everywhere
@both
def test_precision_by_hand(backend, precision):
    """F = a_F y/H + b_F E/E_max below the surface, 1 above it; the time constant, then R and J follow."""
    x = [[0, 0, 2 * D], [D, 0, 2 * D], [0, 0, 9 * D], [0, D, 2 * D]]
    a = arrays(x, [0, 0, 0, 2], precision, velocity=[[0.1, 0.4, 0, 9], [0, 0, 0, 9], [0, 0, 0, 9]])
    pbf = pbf_tuple(real=a["mass"].dtype.type, uniform=0)
    assert run("momentum_size", backend, a)["momentum_size"] == pytest.approx(MASS * np.array([0.1, 0.4, 0, 0]), rel=1e-6)
    run("effect_precision", backend, a, pbf, height=8 * D, dt=0.05)
    F = np.array([0.5 * 0.25 + 0.5 * 0.25, 0.5 * 0.25 + 0.5, 1.0, 0.0])
    assert a["effect_precision"] == pytest.approx(F, rel=1e-6)
    assert a["support_radius"] == pytest.approx(np.array([1.8, 1.8, 2.2, 0]) * D, rel=1e-6)
    assert a["iterations"].tolist() == [2, 3, 4, 0]
    run("effect_precision", backend, a, pbf_tuple(real=a["mass"].dtype.type, uniform=0), height=1.0 * D, dt=0.0125)
    assert a["effect_precision"] == pytest.approx(np.where([1, 1, 1, 0], F + (1 - F) / 4, 0), rel=1e-6)


@everywhere
def test_particles_at_rest_have_the_share_of_their_height(backend):
    a = arrays([[0, 0, 2 * D], [D, 0, 2 * D]])
    run("effect_precision", backend, a, pbf_tuple(uniform=0, minimum_precision=0.2), height=8 * D, dt=1.0)
    assert a["effect_precision"] == pytest.approx([0.2, 0.2])  # 0.125, but F_min = 0.2


@everywhere
def test_keys_and_lists(backend):
    x = np.column_stack([np.arange(6) * 2 * D, np.zeros(6), np.zeros(6)])  # neighbours: the ones beside
    a = arrays(x, [0, 0, 0, 0, 2, 0], iterations=[1, 1, 4, 2, 0, 3])
    pbf = pbf_tuple(uniform=0)
    assert run("iteration_key", backend, a, pbf)["iteration_key"].tolist() == [1, 4, 4, 4, 0, 3]
    for iteration, on in ((0, [0, 1, 2, 3, 5]), (1, [1, 2, 3, 5]), (3, [1, 2, 3]), (4, [])):
        out = run("active_list", backend, a, iteration=iteration)
        assert out["active_index"][: out["active_count"][0]].tolist() == on
    assert run("iteration_key", backend, a)["iteration_key"].tolist() == [4, 4, 4, 4, 0, 4]


@everywhere
def test_lists_over_many_chunks(backend):
    rng = np.random.default_rng(3)
    key = rng.integers(0, 3, 1003)
    a = arrays(rng.uniform(0, 30 * D, (1003, 3)), iteration_key=key)
    out = run("active_list", backend, a, iteration=1)
    assert out["active_index"][: out["active_count"][0]].tolist() == np.flatnonzero(key > 1).tolist()


@everywhere
def test_short_lists_use_the_mean_radius(backend):
    """Strictly below (R_i + R_j)/2; a wall takes the liquid's radius; a list keeps its order."""
    x = [[0, 0, 0], [1.9 * D, 0, 0], [0, 2.02 * D, 0], [0, 0, 1.7 * D], [0, 0, -1.9 * D]]
    R = np.array([1.8, 2.2, 2.2, 0, 0]) * D
    a = arrays(x, [0, 0, 0, 2, 2], support_radius=R)
    run("pbf_list", backend, a, pbf_tuple(uniform=0))
    rows = [a["neighbour_index"][i, :c].tolist() for i, c in enumerate(a["neighbour_count"])]
    assert rows == [[1, 3], [0], [], [], []]


@everywhere
@both
def test_heights(backend, precision):
    z = np.array([-1.0, 0.1, 0.3, 0.3, 9.9, 1e6, 0.3]) * D
    a = arrays(np.column_stack([0 * z, 0 * z, z]), [0, 0, 0, 0, 0, 0, 2], precision, mass=np.full(7, MASS))
    bins = run("height_histogram", backend, a, pbf_tuple(real=a["mass"].dtype.type))["height_bins"]
    assert np.flatnonzero(bins).tolist() == [0, 1, 39] and bins[[0, 1, 39]].tolist() == [2, 2, 2]


def test_surface_is_a_spacing_below_the_95th_percentile():
    bins = np.zeros(80, int)
    bins[:40] = 5  # filled up to 10 spacings
    assert surface_height(bins, D) == pytest.approx((0.25 * 38 - 1) * D)
    bins[79] = 3  # drops do not count
    assert surface_height(bins, D) == pytest.approx((0.25 * 39 - 1) * D)
    assert surface_height(np.zeros(8, int), D) == 0.25 * D
