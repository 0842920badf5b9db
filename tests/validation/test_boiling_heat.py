"""Conduction between particles against analytic solutions, at full size (boiling V9, V10, V11; 2.3 step limit)."""

import numpy as np
import pytest
from boiling_slab import D, Slab
from scipy.special import erfc

LAYERS = 40


def cosine(number=0.2, width=6, **options):
    """V9: T = cos(pi z/L), both faces insulated, until alpha t = 0.1 L^2.

    Return the relative L2 error, and the diffusivity by which the mode decayed, in units of alpha.
    """
    slab = Slab(LAYERS, width, **options)
    k, alpha = np.pi / (LAYERS * D), float(slab.boiling.diffusivity)
    mode = np.cos(k * slab.z)
    slab.T = mode
    steps = round(0.1 * LAYERS**2 / number)
    dt = number * D**2 / alpha
    slab.conduct(dt, steps)
    truth = mode * np.exp(-alpha * k**2 * steps * dt)
    effective = -np.log(slab.T @ mode / (mode @ mode)) / (alpha * k**2 * steps * dt)
    return np.linalg.norm(slab.T - truth) / np.linalg.norm(truth), effective


def hot_floor(number=0.2, width=6, plane=0.5, **options):
    """V10: the floor holds what it touches, T = erfc(z/sqrt(4 alpha t)) above it until sqrt(4 alpha t) = 0.28 L.

    z counts from ``plane`` spacings above the floor: what the floor holds is the row that touches it, which is
    there. Return the largest error of the others.
    """
    slab = Slab(LAYERS, width, **options)
    alpha, reach = float(slab.boiling.diffusivity), 0.28 * LAYERS * D
    steps = round(reach**2 / 4 / number / D**2)
    slab.conduct(reach**2 / 4 / alpha / steps, steps, hot=1.0)
    free = slab.z >= D
    return np.abs(slab.T - erfc((slab.z - plane * D) / reach))[free].max()


def test_v9_cosine_on_the_lattice():
    error, effective = cosine()
    assert error <= 0.001  # 0.0004
    assert effective == pytest.approx(1, abs=5e-4)


@pytest.mark.parametrize("seed", (3, 4))
def test_v9_cosine_on_a_jittered_lattice(seed):
    error, effective = cosine(jitter=0.2, seed=seed)
    assert error <= 0.01  # 0.006
    assert effective == pytest.approx(1, abs=0.008)


@pytest.mark.parametrize("jitter, effective", ((0.0, 0.886), (0.2, 0.94)))
def test_v9_without_correction_diffuses_too_slowly(jitter, effective):
    """(10) diffuses at N_L alpha on the lattice."""
    error, found = cosine(jitter=jitter, corrected=0)
    assert found == pytest.approx(effective, abs=0.007 if jitter else 0.001) and error > 0.05


@pytest.mark.parametrize("precision, change", (("single", 2e-4), ("mixed", 2e-4)))
def test_v9_in_float32(precision, change):
    assert cosine(precision=precision)[0] == pytest.approx(cosine()[0], abs=change)


def test_v9_error_by_support():
    """theta removes most of the dependence on the radius: 0.4 % at 2.2 d, 3 % at 1.6 d on a jittered lattice."""
    assert cosine(jitter=0.2, ratio=2.5)[0] < 0.006 < 0.02 < cosine(jitter=0.2, ratio=1.6)[0] < 0.035


@pytest.mark.parametrize("jitter, most", ((0.0, 0.02), (0.2, 0.03)))
def test_v10_hot_floor(jitter, most):
    assert hot_floor(jitter=jitter) <= most  # 0.014, 0.021


@pytest.mark.slow
def test_v9_v10_on_a_wide_slab():
    for seed in range(2):
        assert cosine(jitter=0.2, width=16, seed=seed)[0] <= 0.01
        assert hot_floor(jitter=0.2, width=16, seed=seed) <= 0.03


@pytest.mark.parametrize("ratio, limit, tolerance", ((2.2, 0.30, 0.005), (1.6, 0.18, 0.01)))
def test_step_limit_of_a_jittered_lattice(ratio, limit, tolerance):
    """dt alpha max sum_j V_j L_ij = 1 at alpha dt/d^2 = 0.30 at R = 2.2 d, 0.18 at 1.6 d."""
    slab = Slab(20, 8, ratio, jitter=0.2)
    slab.run("boil_sums")
    slab.run("boil_rate")
    assert float(slab.boiling.diffusivity) / D**2 / slab.heat_rate.max() == pytest.approx(limit, abs=tolerance)


@pytest.mark.parametrize("radii", (None, (1.8, 2.2)))
def test_v11_heat_and_range_over_a_thousand_steps(radii):
    """Insulated, at 0.8 of the step limit: the heat is kept to 1e-12, and the range to 1e-12."""
    slab = Slab(16, 8, jitter=0.2, radii=radii)
    slab.T = np.random.default_rng(1).uniform(20, 100, slab.core)
    low, high, start = slab.T.min(), slab.T.max(), slab.T.sum()
    slab.run("boil_sums")
    slab.run("boil_rate")
    slab.conduct(0.8 / slab.heat_rate.max(), 1000)
    assert abs(slab.T.sum() / start - 1) <= 1e-12
    assert slab.T.min() >= low - 1e-12 and slab.T.max() <= high + 1e-12
