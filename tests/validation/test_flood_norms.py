"""Error measures of floods on series whose answer is known."""

import numpy as np
import pytest

from experiments import _flood_norms as norms


def test_norms_of_depth_and_velocity():
    assert norms.l1_depth(np.array([1.1, 0.9]), np.array([1.0, 1.0])) == pytest.approx(0.1)
    assert norms.l1_depth(np.array([1.1, 1.0]), np.array([1.0, 1.0]), np.array([1.0, 3.0])) == pytest.approx(0.025)
    assert norms.velocity_error(np.array([1.0, 3.0]), np.array([2.0, 2.0]), np.array([1.0, 0.0])) == pytest.approx(0.5)
    assert norms.velocity_error(np.array([[3.0, 4.0], [0, 0]]), np.array([[0.0, 0], [0, 5]]), np.ones(2)) == pytest.approx(2.0)


def test_places():
    x = np.array([3.0, 0, 1, 2, 4])  # in any order
    depth = np.array([0.0, 1, 1, 0.5, 0])
    assert norms.front_position(x, depth, 0.25) == pytest.approx(2.5)
    assert np.isnan(norms.front_position(x, depth, 2.0)) and np.isnan(norms.jump_position(x, depth, 0.0, 1.0))
    assert norms.front_position(x, depth + 1) == 4
    assert norms.shock_position(x, depth, 1.0, 0.0) == pytest.approx(2.0)
    assert norms.jump_position(np.arange(5.0), np.array([2.0, 1, 1, 2, 2]), 1.0, 2.0, after=0.5) == pytest.approx(2.5)


def test_oscillation_is_fitted():
    t = np.linspace(0, 13.5, 300)
    y = 0.2 + 0.5 * np.cos(2 * np.pi * t / 4.5 - 0.7)
    for guess in (4.2, 4.5, 4.8):
        assert norms.fit_oscillation(t, y, guess) == pytest.approx((0.5, 4.5, 0.7, 0.2), abs=1e-6)


def test_rings_see_asymmetry_and_no_slope():
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-1, 1, (2, 4000))
    r, edges = np.hypot(x, y), np.linspace(0.2, 1.0, 5)
    assert np.nanmax(norms.ring_symmetry(x, y, 2 - r, edges)) < 1e-12
    lopsided = norms.ring_symmetry(x, y, 1 + 0.1 * x, edges)
    assert lopsided == pytest.approx(0.1 * np.array([0.3, 0.5, 0.7, 0.9]) / 2**0.5, rel=0.1)
    assert np.isnan(norms.ring_symmetry(x, y, 2 - r, [5, 6])).all()


def test_gauges():
    t = np.linspace(0, 10, 101)
    t_obs = np.arange(0, 12.0)  # the run ends before the observation does
    assert norms.rmse(t_obs, t_obs, t, t + 0.5) == pytest.approx(0.5) == norms.bias(t_obs, t_obs, t, t + 0.5)
    found = 1.2 * np.exp(-((t - 5) ** 2))
    assert norms.peak(t, found) == pytest.approx((1.2, 5.0))
    assert norms.peak(t, found, end=4.0) == pytest.approx((1.2 * np.exp(-1), 4.0))
    assert norms.arrival(t, t**2, 9.05) == pytest.approx(3.008, abs=0.001)
    assert norms.arrival(t, t + 1, 0.5) == 0 and np.isnan(norms.arrival(t, t, 20.0))
    assert norms.relative_error([1.1, 1.8], np.array([1.0, 2.0])) == pytest.approx([0.1, 0.1])
    assert norms.observed_order([0.04, 0.01], [2.0, 1.0]) == pytest.approx(2.0)
