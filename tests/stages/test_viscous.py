"""Implicit viscosity: its law, pair weights, blocks and one step of conjugate gradients by hand."""

import numpy as np
import pytest
from liquid_cases import both, everywhere, tolerance
from slime_solve_cases import arrays, run

PAIR = [[1], [0]]
#: -W'(r)/r of the cubic spline with h = 0.5 at r = 0.2: 8/(pi h^4) (12 q - 18 q^2)/r, q = 0.4.
F = 8 / (np.pi * 0.0625) * 1.92 / 0.2


@everywhere
@both
def test_shear_rate_of_shear_rotation_and_extension(backend, precision):
    near = [[1, 2, 3], [], [], []]
    g = np.zeros((3, 4, 4))
    g[:, 0, :3] = np.diag([1.0, 1.0, 0.5])
    # g picks columns of the velocity gradient: L = [v_1 - v_0, v_2 - v_0, (v_3 - v_0)/2]
    for differences, expected in (
        ([[0, 0, 0], [6, 0, 0], [0, 0, 0]], 6.0),
        ([[0, 2, 0], [-2, 0, 0], [0, 0, 0]], 0.0),
        ([[2, 0, 0], [0, -1, 0], [0, 0, -2]], np.sqrt(12)),
        ([[0, 1, 0], [0, 0, 3], [8, 0, 0]], np.sqrt(1 + 9 + 16)),
    ):
        v = np.array([[1.0, -2.0, 0.5]] * 4).T
        v[:, 1:] += np.array(differences, float).T
        rate = run("shear_rate", backend, arrays(precision, near=near, velocity=v, pair_gradient=g))["shear_rate"]
        assert rate[0] == pytest.approx(expected, rel=tolerance(precision), abs=1e-12)
        assert not rate[1:].any()


@everywhere
@both
@pytest.mark.parametrize(
    "law, slope, T, expected",
    [(0, 3000, 40, 50), (1, 3000, 40, 50 * np.exp(3000 / 313.15 - 3000 / 293.15)), (2, 0.02, 40, 33.516002301781966)],
)
def test_temperature_law(backend, precision, law, slope, T, expected):
    a = arrays(precision, n=3, phase=[0, 1, 2], temperature=[T] * 3, shear_rate=[])
    mu = run("viscosity", backend, a, law=law, slope=slope)["viscosity"]
    assert mu == pytest.approx([expected, 0, 0], rel=tolerance(precision))


@everywhere
@both
def test_shear_thinning_yield_and_caps(backend, precision):
    a = arrays(precision, n=3, temperature=[], shear_rate=[4.0, 0.0, 1e4])
    values = dict(mu=10.0, power=0.5, yield_stress=8.0, yield_rate=2.0)
    mu = run("viscosity", backend, a, **values)["viscosity"]
    # 10/sqrt(4) + 8 (1 - e^-8)/4; 10/sqrt(1e-6) + 8 2; 10/sqrt(1e4) + 8/1e4
    assert mu == pytest.approx([5 + 2 * (1 - np.exp(-8)), 10016, 0.1008], rel=tolerance(precision))
    mu = run("viscosity", backend, a, **values, smallest=1.0, largest=500.0)["viscosity"]
    assert mu == pytest.approx([5 + 2 * (1 - np.exp(-8)), 500, 1], rel=tolerance(precision))
    a["shear_rate"] = a["shear_rate"][:0]
    assert run("viscosity", backend, a, **values)["viscosity"] == pytest.approx([10] * 3)


def pair(precision, **changed):
    given = dict(
        position=[[0, 0.2], [0, 0], [0, 0]], volume=[0.008, 0.01], mass=[8.0, 10.0], mobility=[1 / 8, 0.1], viscosity=[2.0, 6.0],
    )
    return arrays(precision, near=PAIR, **{**given, **changed})


@everywhere
@both
def test_pair_of_liquids_has_the_harmonic_mean(backend, precision):
    a = pair(precision)
    out = run("pair_shear", backend, a, dt=0.01, floor=0.01, strength=10)
    k = 10 * 3.0 * 0.008 * 0.01 * F / (0.04 + 0.01)
    near = tolerance(precision)
    assert out["pair_shear"][:, 0, 0] == pytest.approx([-0.2 * np.sqrt(k), 0, 0], rel=near)
    assert np.array_equal(out["pair_shear"][:, 1, 0], -out["pair_shear"][:, 0, 0])
    assert out["viscous_block"][:, 0] == pytest.approx([1 / (800 + k * 0.04), 1 / 800, 1 / 800, 0, 0, 0], rel=near)
    assert out["viscous_block"][:, 1] == pytest.approx([1 / (1000 + k * 0.04), 1e-3, 1e-3, 0, 0, 0], rel=near)


@everywhere
@both
def test_wall_and_held_liquid(backend, precision):
    near = tolerance(precision)
    out = run("pair_shear", backend, pair(precision, viscosity=[2.0, 0.0]), dt=0.01, floor=0.01, wall=1.5)
    k = 10 * 1.5 * 2.0 * 0.008 * 0.01 * F / 0.05
    assert out["pair_shear"][0, :, 0] == pytest.approx([-0.2 * np.sqrt(k), 0], rel=near)
    assert out["viscous_block"][0] == pytest.approx([1 / (800 + k * 0.04), 0], rel=near)
    out = run("pair_shear", backend, pair(precision, mobility=[1 / 8, 0]), dt=0.01, floor=0.01, wall=1.5)
    k = 10 * 3.0 * 0.008 * 0.01 * F / 0.05
    assert out["pair_shear"][0, :, 0] == pytest.approx([-0.2 * np.sqrt(k), 0], rel=near)
    assert not out["viscous_block"][:, 1].any()


@everywhere
@both
def test_block_of_the_augmented_lagrangian(backend, precision):
    out = run("pair_shear", backend, pair(precision), dt=0.01, floor=0.01, gamma=10)
    k = 10 * 3.0 * 0.008 * 0.01 * F / 0.05
    g01, g10 = 0.01 * F * 0.2, 0.008 * F * 0.2
    added = 0.008 * 20 * g01**2 + 0.01 * 60 * g10**2  # V_i gamma mu_i G G, and V_j gamma mu_j g_ji g_ji
    assert out["viscous_block"][0, 0] == pytest.approx(1 / (800 + k * 0.04 + added), rel=tolerance(precision))
    held = run("pair_shear", backend, pair(precision, mobility=[1 / 8, 0]), dt=0.01, floor=0.01, gamma=10)
    assert held["viscous_block"][0, 0] == pytest.approx(1 / (800 + k * 0.04 + 0.008 * 20 * g01**2), rel=tolerance(precision))


@everywhere
@pytest.mark.parametrize("precision", ("single", "double"))
def test_block_beside_a_single_neighbour_stays_positive_definite(backend, precision):
    """K is of rank one there and 4e8 times m/dt; off the axes, so that no entry of the matrix is 0."""
    e = np.array([0.48, 0.6, 0.64]) * 0.2
    a = pair(precision, position=np.array([[0, 0, 0], e]).T, viscosity=[1e12, 1e12])
    b = run("pair_shear", backend, a, dt=0.01)["viscous_block"][:, 0].astype(float)
    B = np.array([[b[0], b[3], b[4]], [b[3], b[1], b[5]], [b[4], b[5], b[2]]])
    values = np.linalg.eigvalsh(B)
    assert values[1:] == pytest.approx([1 / 800] * 2, rel=1e-3)
    assert abs(values[0]) < 1e-6 / 800


@everywhere
@both
def test_dilation_is_positive_where_liquid_spreads(backend, precision):
    g = np.zeros((3, 2, 4))
    g[:, 0, 0], g[:, 1, 0] = [2.0, 1, 0], [-3.0, 0, 0]
    a = arrays(precision, near=PAIR, velocity=[[0, 3], [0, 4], [0, 5]], pair_gradient=g, viscosity=[2.0, 5], viscous_block=np.eye(6)[:, :2])
    y = run("dilation", backend, a, gamma=10)["dilation"]
    assert y == pytest.approx([10 * 2 * (2 * 3 + 4), 0])  # the second is not free


@everywhere
@both
def test_start_by_hand(backend, precision):
    g, w, block = np.zeros((3, 2, 4)), np.zeros((3, 2, 4)), np.zeros((6, 2))
    g[0, 0, 0], w[:, 0, 0], block[:, 0] = 2.0, [3, 0, 4], [0.5, 0.25, 1, 0.1, 0, 0]
    a = arrays(
        precision, near=PAIR, mass=[4.0, 1], volume=[0.5, 1], velocity=[[1.0, 0], [0, 0], [2, 0]], velocity_free=[[2.0, 9], [1, 9], [2, 9]],
        pair_gradient=g, pair_shear=w, viscous_block=block, dilation=[3.0, 0], viscous_pressure=[7.0, 0],
    )
    out = run("viscous_start", backend, a, dt=0.5)
    # 8 (1, 1, 0) - (3, 0, 4) (3 + 8) - 0.5 (7 - 3) (2, 0, 0)
    assert out["viscous_residual"].T == pytest.approx(np.array([[-29, 8, -44], [0, 0, 0]]))
    assert out["viscous_direction"].T == pytest.approx(np.array([[-14.5 + 0.8, 2 - 2.9, -44], [0, 0, 0]]))
    sums = out["viscous_sums"].sum(axis=1)
    assert sums[0] == pytest.approx(29 * 13.7 - 8 * 0.9 + 44**2)
    assert sums[3] == pytest.approx(29**2 + 8**2 + 44**2) and sums[4] == pytest.approx(64 * (4 + 1 + 4))
    a["dilation"], a["viscous_pressure"] = a["dilation"][:0], a["viscous_pressure"][:0]
    assert run("viscous_start", backend, a, dt=0.5)["viscous_residual"][:, 0] == pytest.approx([8 - 33, 8, -44])


@everywhere
@both
def test_one_iteration_by_hand(backend, precision):
    g, w, block = np.zeros((3, 2, 4)), np.zeros((3, 2, 4)), np.zeros((6, 2))
    g[0, 0, 0], w[:, 0, 0], block[:3, 0] = 2.0, [3, 0, 4], [0.5, 0.25, 1]
    sums = np.zeros((5, 64))
    sums[0, 5], sums[0, 9] = 40.0, 60.0
    a = arrays(
        precision, near=PAIR, mass=[4.0, 1], volume=[0.5, 1], viscous_direction=[[1.0, 0], [2, 0], [0, 0]], velocity=np.ones((3, 2)),
        viscous_residual=[[20.0, 0], [8, 0], [1, 0]], pair_gradient=g, pair_shear=w, viscous_block=block,
        dilation=[2.0, 0], viscous_sums=sums,
    )
    run("viscous_apply", backend, a, dt=0.5)
    # 8 (1, 2, 0) + 3 (3, 0, 4) - 0.5 2 (2, 0, 0)
    assert a["viscous_product"].T == pytest.approx(np.array([[15, 16, 12], [0, 0, 0]]))
    assert a["viscous_sums"][1].sum() == pytest.approx(47)
    run("viscous_step", backend, a)
    alpha = 100 / 47
    r = np.array([20, 8, 1]) - alpha * np.array([15, 16, 12])
    assert a["velocity"][:, 0] == pytest.approx([1 + alpha, 1 + 2 * alpha, 1], rel=1e-6) and a["velocity"][:, 1] == pytest.approx([1] * 3)
    assert a["viscous_residual"][:, 0] == pytest.approx(r, rel=1e-5)
    new = r @ (r * [0.5, 0.25, 1])
    assert a["viscous_sums"][2].sum() == pytest.approx(new, rel=1e-5) and a["viscous_sums"][3].sum() == pytest.approx(r @ r, rel=1e-5)
    run("viscous_turn", backend, a)
    assert a["viscous_direction"][:, 0] == pytest.approx(r * [0.5, 0.25, 1] + new / 100 * np.array([1, 2, 0]), rel=1e-5)
    assert a["viscous_sums"][0].sum() == pytest.approx(new, rel=1e-5)


@everywhere
@both
def test_no_curvature_makes_no_step(backend, precision):
    a = arrays(precision, n=2, viscous_direction=np.ones((3, 2)), velocity=np.ones((3, 2)))
    run("viscous_step", backend, a)
    run("viscous_turn", backend, a)
    assert np.array_equal(a["velocity"], np.ones((3, 2))) and not a["viscous_direction"].any()


@everywhere
@both
def test_multiplier_takes_the_dilation(backend, precision):
    a = arrays(precision, n=2, dilation=[3.0, -1], viscous_pressure=[1.0, 5])
    assert run("viscous_keep", backend, a)["viscous_pressure"] == pytest.approx([-2, 6])
