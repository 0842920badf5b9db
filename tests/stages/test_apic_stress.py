"""Oldroyd-B: start-up of shear and stretch against their solutions, forces of one particle and of a blob."""

import numpy as np
import pytest
from apic_cases import INACTIVE, W0, W1, WALL, blob, case, run, spread
from liquid_cases import everywhere, tolerance

RELAXATION, MODULUS = 0.5, 300.0


@everywhere
@pytest.mark.parametrize("dimension", (2, 3))
def test_start_up_of_shear(backend, dimension):
    """tau = eta g (1 - e^(-t/l)), N1 = 2 eta l g^2 (1 - (1 + t/l) e^(-t/l)), over three relaxation times.

    Relaxation is of first order: at dt = l/100 tau is off by 1.8e-3 of its end at t = l, N1 by 1.8e-3 (measured).
    """
    rate, dt = 4.0, RELAXATION / 100
    C = np.zeros((9, 2))
    C[2] = rate  # v_x grows along z
    a, grid = case([], np.zeros((2, 3)), apic_affine=C, apic_phase=[0, INACTIVE])
    a["apic_strain"][:, 1] = 3
    worst = np.zeros(2)
    for k in range(300):
        run("apic_strain", backend, a, grid, dt=dt, dimension=dimension)
        t = (k + 1) * dt / RELAXATION
        b = a["apic_strain"][:, 0]
        tau, N1 = MODULUS * b[4], MODULUS * (b[0] - b[2])
        eta = MODULUS * RELAXATION
        end = eta * rate, 2 * eta * RELAXATION * rate**2
        exact = end[0] * (1 - np.exp(-t)), end[1] * (1 - (1 + t) * np.exp(-t))
        worst = np.maximum(worst, [abs(tau - exact[0]) / end[0], abs(N1 - exact[1]) / end[1]])
    assert (worst < 2e-3).all()
    assert a["apic_strain"][:, 0] == pytest.approx([b[0], 1, 1, 0, b[4], 0], rel=1e-12)
    assert (a["apic_strain"][:, 1] == 3).all()


@everywhere
@pytest.mark.parametrize("precision", ("single", "double"))
def test_one_step_by_hand(backend, precision):
    """C = diag(2, -2, 0) and dt = 0.5: F = diag(3, 1/3, 1); dt/l = 1."""
    C = np.diag([2.0, -2, 0]).reshape(9, 1)
    a, grid = case([], [[0, 0, 0]], precision, apic_affine=C)
    run("apic_strain", backend, a, grid, dt=0.5)
    assert a["apic_strain"][:, 0] == pytest.approx([5, 5 / 9, 1, 0, 0, 0], rel=tolerance(precision), abs=1e-6)


@everywhere
def test_a_rotation_turns_the_tensor_and_any_step_keeps_it_positive(backend):
    rng = np.random.default_rng(1)
    w = np.array([[0, -3.0, 1], [3, 0, -2], [-1, 2, 0]])
    a, grid = case([], np.zeros((50, 3)), apic_affine=rng.normal(size=(9, 50)) * 400)
    a["apic_affine"][:, 0] = w.ravel()
    a["apic_strain"][:, 0] = [2, 1, 0.5, 0.1, 0.2, 0.3]
    before = np.linalg.eigvalsh([[2, 0.1, 0.2], [0.1, 1, 0.3], [0.2, 0.3, 0.5]])
    run("apic_strain", backend, a, grid, dt=0.1, relaxation=1e30)
    b = a["apic_strain"][:, :]
    matrices = np.array([[b[0], b[3], b[4]], [b[3], b[1], b[5]], [b[4], b[5], b[2]]]).transpose(2, 0, 1)
    assert np.linalg.eigvalsh(matrices[0]) == pytest.approx(before, rel=1e-12)
    assert (np.linalg.eigvalsh(matrices) > -1e-12 * np.abs(matrices).max()).all()


@everywhere
@pytest.mark.parametrize("precision", ("single", "mixed", "double"))
def test_one_stretched_particle_pulls_two_nodes_together(backend, precision):
    """b_xx = 3, b_xz = 0.5: f = -+ V w G (b - I) D^+ d, with w0 w1 0.2 D^+ = 1/0.2: +-V G (2, 0, 0.5)/0.2 / (1 + dt/l)."""
    x = [[0, 0, 0], [0.2, 0, 0], [0, 0.1, 0]]
    a, grid = case(x, [[0, 0, 0]], precision, phase=[0, 0, WALL], force=1.0, apic_mass=2.0)
    a["apic_strain"][:, 0] = [3, 1, 1, 0, 0.5, 0]
    run("apic_weights", backend, a, grid)
    run("elastic_force", backend, a, grid, dt=0.25)
    pull = 2e-3 * 300 / 1.5 / 0.2 * np.array([2, 0, 0.5])
    assert a["apic_weight"] == pytest.approx(W0 + W1, rel=tolerance(precision))
    assert a["force"].T == pytest.approx(np.array([1 + pull, 1 - pull, [1, 1, 1]]), rel=10 * tolerance(precision), abs=1e-6)


@everywhere
@pytest.mark.parametrize("dimension", (2, 3))
def test_forces_have_neither_a_sum_nor_a_torque(backend, dimension):
    nodes, apics, rng = blob(dimension, 300)
    h, n = spread(dimension, 300), len(apics)
    flat = np.array([1.0, dimension == 3, 1, dimension == 3, 1, dimension == 3])[:, None]
    a, grid = case(nodes, apics, edge=h, apic_mass=rng.uniform(0.5, 1.5, n))
    a["apic_strain"] = a["apic_strain"] + 0.3 * rng.normal(size=(6, n)) * flat
    shape = dict(support=h, dimension=dimension, orphan=1e-9, rank=1e-14)
    run("apic_weights", backend, a, grid, **shape)
    run("elastic_force", backend, a, grid, dt=0.1, **shape)
    f = a["force"]
    assert np.abs(f.sum(axis=1)).max() < 1e-12 * np.abs(f).sum()
    assert np.abs(np.cross(a["position"], f, axis=0).sum(axis=1)).max() < 1e-10 * np.abs(f).sum()
