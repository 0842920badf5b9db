"""Motion of APIC particles: hand sums, conservation, orphans, rules for positions."""

import numpy as np
import pytest
from apic_cases import INACTIVE, W0, W1, blob, case, momentum, periodic, run, spin, spin_of_particles, spread
from liquid_cases import everywhere, tolerance

PRECISIONS = pytest.mark.parametrize("precision", ("single", "mixed", "double"))
w0, w1 = W0 / (W0 + W1), W1 / (W0 + W1)


@everywhere
@PRECISIONS
def test_one_particle_between_two_nodes(backend, precision):
    a, grid = case([[0, 0, 0], [0.2, 0, 0]], [[0, 0, 0]], precision, velocity=[[1.0, 1], [2, 4], [0, -1]], apic_velocity=9.0)
    run("apic_weights", backend, a, grid)
    run("nodes_to_apic", backend, a, grid, dt=0.1)
    near = dict(rel=tolerance(precision), abs=1e-4 if precision != "double" else 1e-10)
    assert a["apic_velocity"][:, 0] == pytest.approx([1, 2 * w0 + 4 * w1, -w1], **near)
    # what two nodes say: 2 m/s and -1 m/s over 0.2 m, along x only
    expected = [0, 0, 0, 10, 0, 0, -5, 0, 0]
    assert a["apic_affine"][:, 0] == pytest.approx(expected, rel=10 * tolerance(precision), abs=1e-4)


@everywhere
@PRECISIONS
def test_share_of_flip(backend, precision):
    kept = [[0.5, 1], [2, 4], [0, 1]]
    given = dict(velocity=[[1.0, 1], [2, 4], [0, -1]], velocity_kept=kept, apic_velocity=[[3.0], [4], [5]])
    a, grid = case([[0, 0, 0], [0.2, 0, 0]], [[0, 0, 0]], precision, **given)
    run("apic_weights", backend, a, grid)
    run("nodes_to_apic", backend, a, grid, dt=0.1, flip=0.25)
    mean, change = np.array([1, 2 * w0 + 4 * w1, -w1]), np.array([0.5 * w0, 0, -2 * w1])
    expected = 0.75 * mean + 0.25 * (np.array([3, 4, 5]) + change)
    assert a["apic_velocity"][:, 0] == pytest.approx(expected, rel=tolerance(precision))


@everywhere
def test_orphans_fall_and_free_slots_rest(backend):
    C = np.arange(27.0).reshape(9, 3)
    x = [[0, 0, 0.1], [3, 0, 0], [0, 0, 0]]
    a, grid = case([[0, 0, 0]], x, apic_phase=[0, 0, INACTIVE], apic_velocity=1.0, apic_affine=C, velocity=5.0, apic_mass=2.5)
    run("apic_weights", backend, a, grid)
    run("nodes_to_apic", backend, a, grid, dt=0.1)
    back = np.argsort(a["apic_id"])
    assert a["apic_velocity"].T[back] == pytest.approx(np.array([[5, 5, 5], [1, 1, 0], [1, 1, 1]]), rel=1e-14)
    assert a["apic_affine"].T[back].tolist() == [[0] * 9, C[:, 1].tolist(), C[:, 2].tolist()]
    run("apic_sums", backend, a, grid)
    assert a["apic_sums"].sum(axis=1).tolist() == [1, 2.5, 2]
    run("apic_to_nodes", backend, a, grid)
    assert a["mass"].sum() + a["apic_sums"][1].sum() == 5.0  # nothing is lost
    run("apic_move", backend, a, grid, dt=0.1)
    moved = a["apic_position"].T[back]
    assert moved == pytest.approx(np.array([[0.5, 0.5, 0.6], [3.1, 0.1, 0], [0, 0, 0]]), rel=1e-14)


@everywhere
@pytest.mark.parametrize("dimension", (2, 3))
def test_momentum_and_spin_are_kept(backend, dimension):
    nodes, apics, rng = blob(dimension, 400)
    flat = np.array([1, 0, 1] if dimension == 2 else [1, 1, 1])[:, None]
    h, n = spread(dimension, 400), len(apics)
    a, grid = case(nodes, apics, edge=h, apic_mass=rng.uniform(0.5, 1.5, n))
    shape = dict(support=h, dimension=dimension, orphan=1e-9, rank=1e-14, massless=1e-30)
    run("apic_weights", backend, a, grid, **shape)
    run("apic_to_nodes", backend, a, grid, **shape)
    a["velocity"] = rng.normal(size=a["velocity"].shape) * flat
    run("nodes_to_apic", backend, a, grid, dt=0.1, **shape)
    m, v = a["mass"], a["velocity"]
    moved = (m * np.abs(v)).sum()
    assert np.abs(momentum(m, v) - momentum(a["apic_mass"], a["apic_velocity"])).max() < 1e-13 * moved
    assert np.abs(spin(a["position"], m, v) - spin_of_particles(a)).max() < 1e-11 * moved
    if dimension == 2:
        C = a["apic_affine"].reshape(3, 3, n)
        assert max(np.abs(C[1]).max(), np.abs(C[:, 1]).max()) < 1e-12 * np.abs(C).max()


@everywhere
@PRECISIONS
def test_rules_for_positions(backend, precision):
    C = np.array([0, 0, 0, 5.0, 0, 0, 0, 0, 0])[:, None]
    given = dict(apic_velocity=[[1.0], [2], [3]], apic_affine=C, apic_weight=1.0, apic_centre=[[0.1], [0], [0.05]])
    a, grid = case([], [[0, 0, 0]], precision, **given)
    near = dict(rel=tolerance(precision))
    assert run("apic_move", backend, dict(a), grid, dt=0.1)["apic_position"][:, 0] == pytest.approx([0.1, 0.15, 0.3], **near)
    literal = run("apic_move", backend, dict(a), grid, dt=0.1, literal=1)["apic_position"][:, 0]
    assert literal == pytest.approx([0.2, 0.2, 0.35], **near)


@everywhere
@PRECISIONS
def test_a_box_is_left_by_one_side_and_entered_by_the_other(backend, precision):
    period = periodic((1, 0, -1), (4, 0, 2))
    x = [[2.875, 9, -0.875], [1.125, 9, -0.125]]
    a, grid = case([], x, precision, period, apic_velocity=[[1.0, -1], [1, 1], [-1, 1]])
    run("apic_move", backend, a, grid, dt=0.25, **period)
    back = np.argsort(a["apic_id"])
    assert a["apic_position"].T[back].tolist() == [[1.125, 9.25, -0.125], [2.875, 9.25, -0.875]]
