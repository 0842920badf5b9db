"""Tait pressure."""

import numpy as np
import pytest
from liquid_cases import both, everywhere, particles, run


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
