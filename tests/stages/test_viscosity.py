"""Laminar viscosity and XSPH."""

import numpy as np
import pytest
from liquid_cases import REALS, both, everywhere, particles, run, tolerance

L, W1 = 275.0197417, 8.63765707  # L_visc(0.2), W_cubic(0.2), h = 0.5


@everywhere
@both
def test_laminar_force_of_a_liquid_pair(backend, precision):
    a = particles(
        [[0, 0, 0], [0.2, 0, 0]], 0, precision, velocity=[[0.0, 0], [0, 3], [1, 0]], density=[1000.0, 500.0]
    )
    F = run("laminar_force", backend, a, mu=0.5)["force"]
    size = 0.5 * 0.008 * 0.016 * L
    assert F.T == pytest.approx(size * np.array([[0, 3, -1], [0, -3, 1]]), rel=tolerance(precision) + 1e-9)


@everywhere
@both
def test_laminar_force_of_a_boundary(backend, precision):
    for partner in (1, 2):
        a = particles(
            [[0, 0, 0], [0.2, 0, 0]],
            [0, partner],
            precision,
            velocity=[[0.0, 0], [2, 0], [0, 0]],
            density=[1010.0, 400.0],
            volume=[0.008, 0.006],
            force=np.ones((3, 2)),
        )
        # (3'): mu (m_i/rho_i) (m_i phi_k/rho_i) (v_k - v_i) L, m_i phi_k = rho0_i V_k
        size = 0.5 * (8 / 1010) * (1000 * 0.006 / 1010) * L * -2
        F = run("laminar_force", backend, a, mu=0.5)["force"]
        assert F[:, 0] == pytest.approx([1, 1 + size, 1], rel=tolerance(precision) + 1e-9)
        assert F[:, 1] == pytest.approx(
            [1, 1 - size if partner == 1 else 1, 1], rel=tolerance(precision) + 1e-9
        )


def crowd(precision, phases):
    rng = np.random.default_rng(4)
    n = 150
    x = rng.uniform(0, 1.0, (n, 3))
    x[3] = x[4]
    return particles(
        x,
        rng.choice(phases, n),
        precision,
        velocity=rng.normal(size=(3, n)),
        mass=rng.uniform(0.1, 10, n),
        volume=rng.uniform(0.5, 1.5, n) * 0.008,
        density=rng.uniform(900, 1100, n),
    )


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_momentum(backend, precision):
    a = crowd(precision, (0, 1))
    eps = np.finfo(a["mass"].dtype).eps
    F = run("laminar_force", backend, a, mu=2)["force"].astype(float)
    assert np.abs(F.sum(axis=1)).max() <= 20 * eps * np.abs(F).sum() and np.abs(F).max() > 0
    a = crowd(precision, (0, 5))
    dv = run("xsph", backend, a, xsph=0.5)["velocity_next"].astype(float) - a["velocity"]
    p = dv * a["mass"].astype(float)
    assert np.abs(p.sum(axis=1)).max() <= 40 * eps * np.abs(p).sum() and np.abs(p).max() > 0


@everywhere
@both
def test_xsph_of_a_pair(backend, precision):
    a = particles(
        [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0]],
        [0, 0, 1],
        precision,
        velocity=[[0.0, 4, 9], [0, 0, 9], [0, 0, 9]],
        density=[900.0, 1100.0, 5.0],
    )
    v = run("xsph", backend, a, xsph=0.5)["velocity_next"]
    dv = 0.5 * 8 / 1000 * 4 * W1
    assert v.T == pytest.approx(
        np.array([[dv, 0, 0], [4 - dv, 0, 0], [9, 9, 9]]), rel=tolerance(precision) + 1e-8
    )


@everywhere
def test_alone_and_empty(backend):
    a = particles([[0, 0, 0]], velocity=[[1.0], [2], [3]])
    assert run("xsph", backend, a, xsph=0.5)["velocity_next"][:, 0].tolist() == [1, 2, 3]
    assert (run("laminar_force", backend, a, mu=1)["force"] == 0).all()
    none = particles(np.zeros((0, 3)))
    assert run("xsph", backend, none)["velocity_next"].shape == (3, 0)
    assert run("laminar_force", backend, none)["force"].shape == (3, 0)
