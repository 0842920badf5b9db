"""Density: lattice values, hand sums, and who counts."""

import numpy as np
import pytest
from liquid_cases import DX, REALS, both, box, everywhere, particles, run, tolerance

from melt import params as P

W0, W1 = 20.3718327158, 8.6376570716  # cubic spline at 0 and at r = 0.2, h = 0.5


@everywhere
@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("kernel, factor", ((P.CUBIC, 0.9985), (P.WENDLAND2, 1.0134), (P.MUELLER, 0.9954)))
def test_inside_a_full_lattice(backend, precision, kernel, factor):
    x = box(7, 7, 7)
    centre = np.flatnonzero((np.abs(x - 3.5 * DX) < 1e-9).all(axis=1))[0]
    a = particles(x, 0, precision)
    rho = run("density", backend, a, kernel=kernel)["density"]
    assert a["neighbour_count"][centre] == 80
    assert rho[centre] == pytest.approx(1000 * factor, abs=0.1)
    scaled = run("density", backend, a, kernel=kernel, density_factor=1 / factor)["density"]
    assert scaled[centre] == pytest.approx(1000, abs=0.1)


@everywhere
@both
def test_one_particle_has_its_own_term_only(backend, precision):
    rho = run("density", backend, particles([[1, 2, 3]], 0, precision))["density"]
    assert rho == pytest.approx(8 * W0, rel=tolerance(precision))


@everywhere
@both
def test_pair_with_a_solid_and_a_wall(backend, precision):
    x = [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2], [0, 0, -0.5]]
    a = particles(
        x, [0, 1, 2, 5, 0], precision, volume=[0.008, 0.77 * 0.008, 0.008, 0.0, 0.008], rest_volume=[0.01] * 5
    )
    rho = run("density", backend, a)["density"]
    # number-density form: m_i (sum_j W + sum_k phi_k W), eq (1); r = h and inactive do not count
    assert rho[0] == pytest.approx(8 * (W0 + 0.77 * W1 + W1), rel=tolerance(precision))
    assert rho[1:3] == pytest.approx([800, 800]) and rho[3] == 0
    assert rho[4] == pytest.approx(8 * W0, rel=tolerance(precision))


@everywhere
@both
def test_unequal_volumes(backend, precision):
    a = particles([[0, 0, 0], [0.2, 0, 0]], 0, precision, volume=[0.008, 0.004], mass=[8.0, 2.0])
    rho = run("density", backend, a)["density"]
    expected = [1000 * (0.008 * W0 + 0.004 * W1), 500 * (0.004 * W0 + 0.008 * W1)]
    assert rho == pytest.approx(expected, rel=tolerance(precision))


@everywhere
@both
def test_coincident_and_empty(backend, precision):
    rho = run("density", backend, particles([[0, 0, 0], [0, 0, 0]], 0, precision))["density"]
    assert rho == pytest.approx(16 * W0, rel=tolerance(precision))
    assert run("density", backend, particles(np.zeros((0, 3)), 0, precision))["density"].size == 0
