"""ISPH pressure: matrix entries, right-hand side, one step of conjugate gradients and the cut of tension by hand."""

import numpy as np
import pytest
from liquid_cases import both, everywhere, tolerance
from slime_solve_cases import arrays, run

PAIR = [[1], [0]]
F = 8 / (np.pi * 0.0625) * 1.92 / 0.2  # -W'(r)/r at r = 0.2, h = 0.5


@everywhere
@both
def test_entries_of_a_pair_beside_a_wall(backend, precision):
    a = arrays(
        precision, near=[[1, 2], [0, 2], []], position=[[0, 0.2, 0], [0, 0, 0.2], [0, 0, 0]], volume=[0.008, 0.01, 0.02],
        completed_ratio=[0.8, 0.25, 1.0], dfsph_factor=[1.0, 2.0, 0], ghost_laplacian=[7.0, 0, 9],
    )
    out = run("poisson_pairs", backend, a, floor=0.01)
    s = 2 * 0.01 * 0.02 * F * 0.04 / 0.05  # volumes over 0.8, and over a half
    near = tolerance(precision)
    assert out["pair_poisson"][:, 0] == pytest.approx([s, s, 0], rel=near)
    assert out["pair_poisson"][0, 0] == out["pair_poisson"][1, 0] and not out["pair_poisson"][:, 1].any()
    assert out["poisson_ghost"] == pytest.approx([4 * 0.01 * 7, 0, 0], rel=near)
    assert out["poisson_diagonal"] == pytest.approx([s + 0.28, s, 0], rel=near)
    a["ghost_laplacian"] = a["ghost_laplacian"][:0]
    assert run("poisson_pairs", backend, a, floor=0.01)["poisson_diagonal"] == pytest.approx([s, s, 0], rel=near)


@everywhere
@both
def test_start_by_hand(backend, precision):
    g, s = np.zeros((3, 3, 4)), np.zeros((3, 4))
    g[:, 0, 0], g[:, 0, 1], s[0, 0], s[1, 0] = [2, 1, 0], [0, 0, -1], 3, 3
    a = arrays(
        precision, near=[[1, 2], [0], []], velocity=[[1.0, 4, 0], [0, 1, 0], [2, 0, 5]], volume=[0.5, 0.4, 1],
        completed_ratio=[0.8, 1.1, 1],
        pair_gradient=g, pair_poisson=s, poisson_ghost=[2.0, 0, 0], poisson_diagonal=[5.0, 3, 0], poisson_pressure=[10.0, 4, 0],
    )
    out = run("poisson_start", backend, a, dt=0.5, rest_density=10, pull=0.1)
    # rate = -3 2 - 1 + 3; b = 0.625 10 (rate/0.8/0.5 + 0.1 (-0.2)/0.25); S p = 3 6 + 2 10
    b = 6.25 * (-4 / 0.4 - 0.08)
    assert out["poisson_residual"] == pytest.approx([b - 38, 18, 0], rel=tolerance(precision))
    assert out["poisson_direction"] == pytest.approx([(b - 38) / 5, 6, 0], rel=tolerance(precision))
    sums = out["poisson_sums"].sum(axis=1)
    assert sums[[0, 3, 4]] == pytest.approx([(b - 38) ** 2 / 5 + 108, (b - 38) ** 2 + 324, b**2], rel=tolerance(precision))


@everywhere
@both
def test_one_iteration_by_hand(backend, precision):
    s, sums = np.zeros((3, 4)), np.zeros((5, 64))
    s[0, 0] = s[1, 0] = 3.0
    sums[0, 1], sums[0, 63] = 8.0, 4.0
    a = arrays(
        precision, near=[[1], [0], []], pair_poisson=s, poisson_ghost=[2.0, 0, 0], poisson_diagonal=[5.0, 3, 0],
        poisson_direction=[1.0, 2, 0],
        poisson_pressure=[10.0, 4, 0], poisson_residual=[6.0, 1, 0], poisson_sums=sums,
    )
    run("poisson_apply", backend, a)
    assert a["poisson_product"] == pytest.approx([3 * -1 + 2, 3, 0]) and a["poisson_sums"][1].sum() == pytest.approx(5)
    run("poisson_step", backend, a)  # alpha = 12/5
    assert a["poisson_pressure"] == pytest.approx([12.4, 8.8, 0]) and a["poisson_residual"] == pytest.approx([8.4, -6.2, 0], rel=1e-6)
    new = 8.4**2 / 5 + 6.2**2 / 3
    assert a["poisson_sums"][2].sum() == pytest.approx(new, rel=1e-6)
    assert a["poisson_sums"][3].sum() == pytest.approx(8.4**2 + 6.2**2, rel=1e-6)
    run("poisson_turn", backend, a)
    assert a["poisson_direction"] == pytest.approx([8.4 / 5 + new / 12, -6.2 / 3 + 2 * new / 12, 0], rel=1e-5)
    assert a["poisson_sums"][0].sum() == pytest.approx(new, rel=1e-6)


@everywhere
@both
def test_constant_pressure_of_closed_liquid_meets_no_resistance(backend, precision):
    """To the last bit: otherwise rounding would drive the pressure of a full vessel, which the matrix leaves open."""
    s = np.zeros((3, 4))
    s[:, :2] = [[0.1, 0.7], [0.1, 0.3], [0.7, 0.3]]
    a = arrays(precision, near=[[1, 2], [0, 2], [0, 1]], pair_poisson=s, poisson_direction=[12345.678] * 3)
    assert not run("poisson_apply", backend, a)["poisson_product"].any()


@everywhere
@both
def test_tension_is_cut_where_asked(backend, precision):
    given = dict(
        density_ratio=[0.8, 0.9, 0.8, 0.9], completed_ratio=[1.0, 0.5, 2, 1],
        poisson_diagonal=[1.0, 1, 1, 0], poisson_pressure=[-4.0, -4, 8, 3],
    )
    a = arrays(precision, n=4, **given)
    out = run("poisson_finish", backend, a)
    assert out["poisson_pressure"] == pytest.approx([0, -4, 8, 0]) and out["solver_pressure"] == pytest.approx([0, -16, 2, 0])
    out = run("poisson_finish", backend, arrays(precision, n=4, **given), clamp=1)
    assert out["poisson_pressure"] == pytest.approx([0, 0, 8, 0]) and out["solver_pressure"] == pytest.approx([0, 0, 2, 0])
