"""Tait pressure, and the pressure that boundaries carry."""

import numpy as np
import pytest
from liquid_cases import both, box, everywhere, particles, run, tolerance


def close(p, expected, precision, stiffness):
    """Within a few roundings of the density ratio, which the stiffness B times 7 amplifies."""
    return p == pytest.approx(
        expected, rel=1e-12, abs=7 * stiffness * (4e-7 if precision == "single" else 1e-15)
    )


@everywhere
@both
def test_by_hand(backend, precision):
    rho = np.array([1000.0, 1010.0, 990.0, 1010.0, 1010.0, 1010.0])
    a = particles(np.arange(18).reshape(6, 3), [0, 0, 0, 1, 2, 5], precision, density=rho)
    B = 1000 * 100 / 7
    p = run("tait_pressure", backend, a)["pressure"]
    assert close(p, [0, B * (1.01**7 - 1), 0, 0, 0, 0], precision, B)
    assert (p >= 0).all() and (p[2:] == 0).all()
    p = run("tait_pressure", backend, a, clamp=0)["pressure"]
    assert close(p[2], B * (0.99**7 - 1), precision, B)


@everywhere
@both
def test_rest_density_is_the_particle_s_own(backend, precision):
    a = particles(
        np.zeros((2, 3)), 0, precision, mass=[8.0, 4.0], volume=[0.008, 0.005], density=[1000.0, 808.0]
    )
    p = run("tait_pressure", backend, a, sound_speed=20)["pressure"]
    B = 800 * 400 / 7
    assert close(p, [0, B * (1.01**7 - 1)], precision, B)


@everywhere
def test_nan_shows_and_empty_is_legal(backend):
    a = particles(np.zeros((1, 3)), density=[np.nan])
    assert np.isnan(run("tait_pressure", backend, a)["pressure"][0])
    assert run("tait_pressure", backend, particles(np.zeros((0, 3))))["pressure"].size == 0


W0, W1 = 20.3718327, 8.63765707  # cubic spline, h = 0.5, at 0 and 0.2


@everywhere
@both
def test_boundary_pressure_by_hand(backend, precision):
    # liquid 0 with liquid 1 below it, liquid 3 alone, a wall beside 0; 4 is out of everything's reach
    x = [[0, 0, 0], [0, 0, -0.2], [0.2, 0, 0], [5, 0, 0], [9, 9, 9]]
    a = particles(x, [0, 0, 2, 0, 1], precision, pressure=[3000.0, 5000.0, 77.0, 400.0, 77.0])
    P = run("boundary_pressure", backend, a, gravity_z=-10)["boundary_pressure"]
    mean = (3000 * W0 + 5000 * W1) / (W0 + W1)
    head = 1000 * -10 * 0.2 * W1 / (W0 + W1)  # rho g . x_01: the mean was taken below
    near = max(tolerance(precision), 1e-8)
    assert P[0] == pytest.approx(mean + head, rel=near)
    assert P[1] == pytest.approx((5000 * W0 + 3000 * W1) / (W0 + W1) - head, rel=near)  # 0.28 from the wall
    assert (P[2:] == [0, 400, 0]).all()  # far from walls a liquid's own; others have none


@everywhere
@both
def test_boundary_pressure_of_a_hydrostatic_liquid_is_its_own(backend, precision):
    x = box(7, 7, 7)
    p = 2e4 - 1000 * 10 * x[:, 2]
    a = particles(x, np.where(x[:, 0] < 1, 0, 2), precision, pressure=np.where(x[:, 0] < 1, p, 1e9))
    P = run("boundary_pressure", backend, a, gravity_z=-10)["boundary_pressure"]
    assert P[a["phase"] == 0] == pytest.approx(p[a["phase"] == 0], rel=10 * tolerance(precision))


@everywhere
@both
def test_a_drop_without_pressure_has_no_head(backend, precision):
    a = particles([[0, 0, 0], [0, 0, 0.2], [0.2, 0, 0]], [0, 0, 1], precision)
    assert (run("boundary_pressure", backend, a, gravity_z=-10)["boundary_pressure"] == 0).all()
    a = particles([[0, 0, 0], [0, 0, 0.2], [0.2, 0, 0]], [0, 0, 1], precision, pressure=[9.0, 9.0, 0.0])
    P = run("boundary_pressure", backend, a, gravity_z=-10)["boundary_pressure"]
    assert P[:2] == pytest.approx([18, 0], abs=1e-5)  # within 0 and twice the mean


@everywhere
def test_boundary_pressure_of_nothing(backend):
    assert run("boundary_pressure", backend, particles(np.zeros((0, 3))))["boundary_pressure"].size == 0
