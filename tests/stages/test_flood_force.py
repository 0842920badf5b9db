"""Forces between columns of water: pairs by hand, conservation, energy, stabilisation, walls, the bed (flood E6, E7, E10, E16)."""

import numpy as np
import pytest
from flood_force_cases import AIRBORNE, INACTIVE, LIQUID, G, W, both, cloud, columns, dW, everywhere, run
from scipy.optimize import brentq

from melt import params as P

FORMS = (P.FORM_VARIATIONAL, P.FORM_SYMMETRIC, P.FORM_LINEAR)


def tolerance(precision):
    return 3e-6 if precision == "single" else 1e-12


@everywhere
@both
@pytest.mark.parametrize("kernel", [P.CUBIC, P.WENDLAND2])
def test_pair_by_hand(backend, precision, kernel):
    """E6: supports, volumes and factors of their own; column 0 is at the left and is pushed to the left."""
    V, h, Omega, r = [0.8, 1.3], [2.0, 3.0], [0.8, 1.1], 0.9
    a = columns([[0, 0], [r, 0]], precision, rest_volume=V, support_radius=h, support_factor=Omega, bed_slope=[[0.1, 0], [0, -0.2]])
    found = run("flood_force", backend, a, kernel=kernel, sigma=0.97)
    slope = G / 2 * 0.97 * sum(dW(r, h[k], kernel) / Omega[k] for k in (0, 1))
    expected = [[V[1] * slope - 0.1 * G, -V[0] * slope], [0, 0.2 * G]]
    assert found == pytest.approx(np.array(expected), rel=tolerance(precision), abs=1e-7)
    found = run("flood_force", backend, a, kernel=kernel, form=P.FORM_SYMMETRIC)
    slope = G / 2 * (dW(r, h[0], kernel) + dW(r, h[1], kernel))
    assert found[0] + [0.1 * G, 0] == pytest.approx([V[1] * slope, -V[0] * slope], rel=2 * tolerance(precision))


@everywhere
def test_each_kernel_ends_at_its_own_support(backend):
    """Within the larger support only: one kernel acts, on both columns alike."""
    a = columns([[0, 0], [0, 1.5]], support_radius=[1.0, 2.0], support_factor=[0.9, 0.7])
    push = G / 2 * dW(1.5, 2.0) / 0.7
    assert run("flood_force", backend, a)[1] == pytest.approx([push, -push], rel=1e-12)


@everywhere
@pytest.mark.parametrize("form", FORMS)
def test_momentum_and_spin_are_conserved(backend, form):
    """Pairs are equal and opposite; without E7 they act along the line between both."""
    a = cloud()
    V, x = a["rest_volume"], a["position"]
    F = V * run("flood_force", backend, a, form=form, lax_friedrichs=1.0, viscosity=0.3)
    assert np.abs(F.sum(axis=1)).max() <= 1e-13 * np.abs(F).sum() and np.abs(F).max() > 1
    F = V * run("flood_force", backend, a, form=form, lax_friedrichs=1.0)
    turn = x[0] * F[1] - x[1] * F[0]
    assert abs(turn.sum()) <= 1e-13 * np.abs(turn).sum()


@everywhere
@pytest.mark.parametrize("form", FORMS)
def test_lattice_at_rest_is_not_pushed(backend, form):
    i, j = np.divmod(np.arange(121), 11)
    a = columns(np.column_stack([i, j]), depth=np.full(121, 1.4), rest_volume=np.full(121, 1.4))
    found = run("flood_force", backend, a, form=form, lax_friedrichs=1.0, viscosity=0.1)
    inside = (np.abs(i - 5) < 3) & (np.abs(j - 5) < 3)
    assert np.abs(found[:, inside]).max() <= 1e-13
    assert np.abs(found[:, ~inside]).max() > 1


def depths(x, V, walls, ratio=2.66, d_ref=1.0):
    """d = sum V W(h) with h = ratio sqrt(V/d), walls as in the paper: one equation per column, solved by bisection."""
    r = np.hypot(*(x[:, None] - x[None]).transpose(2, 0, 1))
    r_b = np.hypot(*(x[:, None] - walls[None, :, :2]).transpose(2, 0, 1))

    def residual(d, i):
        h = ratio * np.sqrt(V[i] / d)
        return d - (V * W(r[i], h)).sum() - d_ref * (walls[:, 3] * W(r_b[i], h)).sum()

    d = np.array([brentq(residual, 0.2, 20, args=(i,), xtol=1e-15, rtol=1e-15) for i in range(len(x))])
    h = ratio * np.sqrt(V / d)
    alpha = -(V * r * dW(r, h[:, None])).sum(axis=1) - d_ref * (walls[:, 3] * r_b * dW(r_b, h[:, None])).sum(axis=1)
    return d, h, alpha / (2 * d)


def bed(x):
    return 0.3 * x[..., 0] ** 2 - 0.2 * x[..., 0] * x[..., 1] + 0.1 * x[..., 1]


@everywhere
def test_variational_force_is_the_slope_of_the_energy(backend):
    """E = sum V (g d/2 + g b), with the depths solved anew for each place; walls that carry the reference depth, too."""
    rng = np.random.default_rng(4)
    i, j = np.divmod(np.arange(16), 4)
    x = 0.8 * np.column_stack([i, j]) + rng.uniform(-0.2, 0.2, (16, 2))
    V = rng.uniform(0.6, 1.2, 16)
    walls = np.column_stack([np.full(5, -0.9), np.arange(5) * 0.7, np.zeros(5), np.full(5, 0.6)])

    def energy(x):
        return (V * (G / 2 * depths(x, V, walls)[0] + G * bed(x))).sum()

    d, h, Omega = depths(x, V, walls)
    slope = [0.6 * x[:, 0] - 0.2 * x[:, 1], 0.1 - 0.2 * x[:, 0]]
    a = columns(x, rest_volume=V, depth=d, support_radius=h, support_factor=Omega, bed_slope=slope, bed=bed(x), walls=walls)
    run("flood_force", backend, a)
    found = V * run("wall_force", backend, a, wall_mirror=0)
    step = 1e-4
    for k in range(16):
        for axis in (0, 1):
            to = np.zeros((16, 2))
            to[k, axis] = step
            # fourth order: the kernel's third derivative jumps
            near, far = (energy(x + m * to) - energy(x - m * to) for m in (0.5, 1))
            assert found[axis, k] == pytest.approx(-(8 * near - far) / (6 * step), rel=1e-6, abs=1e-6)


@everywhere
@both
def test_only_pairs_that_approach_are_slowed(backend, precision):
    """E10: Pi = alpha c v_ij / d sqrt(1 + 0.01 l^2/r^2) with means of both columns."""
    V, h, d, r, alpha = [0.8, 1.3], [2.0, 3.0], [0.5, 2.0], 0.9, 0.7
    for u in (2.0, -2.0):
        a = columns([[0, 0], [r, 0]], precision, rest_volume=V, support_radius=h, depth=d, velocity=[[u, 0], [0, 5]])
        off, on = (run("flood_force", backend, a, lax_friedrichs=f) for f in (0.0, alpha))
        c, mean, ell = (np.sqrt(G * np.array(d))).mean(), np.mean(d), np.mean(h) / 2
        Pi = alpha * c * u * r / (mean * np.sqrt(r**2 + 0.01 * ell**2)) if u > 0 else 0.0
        push = Pi * (dW(r, 2.0) + dW(r, 3.0)) / 2
        assert on - off == pytest.approx(np.array([[V[1] * push, -V[0] * push], [0, 0]]), rel=1e-5, abs=4e-6)
        assert (u > 0) == (abs(push) > 0.5)


@everywhere
def test_shear_is_damped_by_viscosity(backend):
    """E7: nu = mu/rho; along the line and across it alike, and towards the partner's velocity."""
    V, r, nu = [0.8, 1.3], 0.9, 0.05
    a = columns([[0, 0], [r, 0]], rest_volume=V, depth=[0.5, 1.5], velocity=[[0, 0], [0, 3.0]])
    off, on = (run("flood_force", backend, a, viscosity=f) for f in (0.0, nu))
    share = nu * 2 * abs(dW(r, 2.66)) / (r + 0.0133) * 3.0 / 1.0
    assert (on - off)[1] == pytest.approx([V[1] * share, -V[0] * share], rel=1e-10)
    assert (on == off)[0].all()


@everywhere
def test_linear_equation_of_state_pulls_below_its_depth(backend):
    """P = k (d - d_ref), push (P_i/d_i^2 + P_j/d_j^2)/2 of both kernels; the clamp leaves nothing of the pull."""
    d = np.array([0.5, 0.8])
    a = columns([[0, 0], [0.9, 0]], depth=d, support_radius=[2.0, 3.0])
    P_over = 10 * (d - 1.0) / d**2
    slope = P_over.sum() * (dW(0.9, 2.0) + dW(0.9, 3.0)) / 2
    found = run("flood_force", backend, a, form=P.FORM_LINEAR)
    assert found[0] == pytest.approx([slope, -slope], rel=1e-12) and found[0, 0] > 0, "pulled to the right"
    assert (run("flood_force", backend, a, form=P.FORM_LINEAR, clamp=1) == 0).all()
    assert run("flood_force", backend, a, form=P.FORM_LINEAR, reference_depth=0.1)[0, 0] < 0


@everywhere
@both
def test_columns_at_one_place_are_taken_apart(backend, precision):
    """A thousandth of the mean support along a direction that both ids draw: equal and opposite, whichever comes first."""
    found = {}
    for ids in ((3, 8), (8, 3)):
        a = columns([[0.3, 0.4]] * 2, precision, id=ids, support_radius=[2.0, 3.0])
        found[ids] = run("flood_force", backend, a)
        push = -G / 2 * (dW(2.5e-3, 2.0) + dW(2.5e-3, 3.0))
        assert np.hypot(*found[ids]) == pytest.approx(push, rel=1e-5)
        assert found[ids][:, 0] == pytest.approx(-found[ids][:, 1], rel=1e-5)
    assert found[3, 8][:, 0] == pytest.approx(found[8, 3][:, 1], rel=1e-5)
    a = columns([[0.3, 0.4]] * 2, precision, velocity=[[1, 0], [0, 0]], depth=[1.0, 1.3], support_radius=[2.0, 3.0])
    for stage in ("flood_force", "balanced_force"):
        moving = run(stage, backend, {**a}, lax_friedrichs=1.0, viscosity=0.1)
        assert np.isfinite(moving).all() and np.hypot(*moving).min() > 1e-5


@everywhere
def test_three_at_one_place_beside_others(backend):
    """Momentum, in a crowd with every second column on top of its predecessor."""
    a = cloud(40)
    a["position"][:, 1::2] = a["position"][:, ::2]
    x = a["position"][:2].T
    a = columns(x, **{k: a[k] for k in ("rest_volume", "depth", "support_radius", "support_factor", "velocity", "id")})
    F = a["rest_volume"] * run("flood_force", backend, a, lax_friedrichs=1.0, viscosity=0.3)
    assert np.isfinite(F).all() and np.abs(F.sum(axis=1)).max() <= 1e-13 * np.abs(F).sum()


@everywhere
@pytest.mark.parametrize("stage", ["flood_force", "balanced_force"])
def test_columns_that_fall_or_wait_have_no_force_and_give_none(backend, stage):
    x = np.array([[0, 0], [0.5, 0], [0.2, 0.3], [1, 1]])
    a = columns(x, phase=[LIQUID, AIRBORNE, INACTIVE, LIQUID], bed_slope=np.ones((2, 4)))
    found = run(stage, backend, a)
    alone = run(stage, backend, columns(x[[0, 3]], bed_slope=np.ones((2, 2))))
    assert (found[:, 1:3] == 0).all() and found[:, [0, 3]] == pytest.approx(alone, rel=1e-12)


@everywhere
@pytest.mark.parametrize("stage", ["flood_force", "balanced_force", "wall_force", "constrain_to_bed"])
def test_no_columns(backend, stage):
    assert run(stage, backend, columns(np.zeros((0, 2)))).shape == (2, 0)


@everywhere
@pytest.mark.parametrize("field", ["position", "velocity", "depth", "support_radius", "support_factor", "rest_volume"])
def test_nan_does_not_hide(backend, field):
    a = cloud(20)
    a[field][..., 7] = np.nan
    found = run("flood_force", backend, a, lax_friedrichs=1.0)
    assert np.isnan(np.delete(found, 7, axis=1)).any(), "partners"
    assert field == "rest_volume" or np.isnan(found[:, 7]).any(), "itself"


@everywhere
def test_wall_by_hand(backend):
    """E16: the stage mirrored, g d_ib V_b; dry ground beside the water does not push; the reference depth in the paper's."""
    walls = [[1.0, 0, 0.4, 0.3], [0, 1.0, 9.0, 0.5]]
    a = columns([[0, 0]], depth=[1.5], bed=[0.2], support_factor=[0.8], walls=walls, acceleration=[[1.0], [2.0]])
    slope = dW(1.0, 2.66)
    found = run("wall_force", backend, {**a})[:, 0]
    assert found == pytest.approx([1 + G * 1.3 * 0.3 * slope / 0.8, 2.0], rel=1e-12)
    found = run("wall_force", backend, {**a}, form=P.FORM_SYMMETRIC, wall_mirror=0)[:, 0]
    assert found == pytest.approx([1 + G / 2 * 0.3 * slope, 2 + G / 2 * 0.5 * slope], rel=1e-12)
    found = run("wall_force", backend, {**a}, form=P.FORM_LINEAR, wall_mirror=0)[:, 0]
    assert found == pytest.approx([1 + 5 / 2.25 * 0.3 * slope, 2 + 5 / 2.25 * 0.5 * slope], rel=1e-12)


@everywhere
def test_mirrored_walls_close_a_lattice(backend):
    """Half of a lattice at rest, the other half boundary particles of unit area: nothing is pushed."""
    i, j = np.divmod(np.arange(121), 11)
    x, left = np.column_stack([i, j]), i < 6
    walls = np.column_stack([x[~left], np.zeros((~left).sum()), np.ones((~left).sum())])
    a = columns(x[left], depth=np.full(66, 1.4), rest_volume=np.full(66, 1.4), walls=walls)
    run("flood_force", backend, a)
    inside = (i[left] > 2) & (np.abs(j[left] - 5) < 3)
    assert np.abs(a["acceleration"][:, inside]).max() > 3
    assert np.abs(run("wall_force", backend, a)[:, inside]).max() <= 1e-13


@everywhere
def test_a_slope_along_a_mirrored_wall_pushes_in_full(backend):
    """Beside a wall half of the support is closed by columns of the same stage: without a remedy half of g S is left."""
    i, j = np.divmod(np.arange(15 * 21), 21)
    x, left = np.column_stack([i, j]).astype(float), i < 7
    walls = np.column_stack([x[~left], np.zeros((~left).sum()), np.ones((~left).sum())])
    d = 1 + 0.01 * (x[left, 1] - 10)
    a = columns(x[left], depth=d, rest_volume=d, walls=walls)
    run("flood_force", backend, a)
    free, beside = (np.flatnonzero((x[left] == place).all(axis=1))[0] for place in ((3, 10), (6, 10)))
    assert a["acceleration"][1, free] == pytest.approx(-0.01 * G, rel=0.02)
    assert 0.5 < a["acceleration"][1, beside] / a["acceleration"][1, free] < 0.8
    run("wall_force", backend, a)
    assert a["acceleration"][:, beside] == pytest.approx(a["acceleration"][:, free], rel=0.02, abs=1e-6)


@everywhere
def test_scene_without_walls_is_left_alone(backend):
    a = columns([[0, 0], [1, 0]], acceleration=[[1, 2], [3, 4]])
    assert a["wall_count"].shape == (0,)
    assert run("wall_force", backend, a).tolist() == [[1, 2], [3, 4]]


@everywhere
@pytest.mark.parametrize("slope", [0.1, 1.0, 3.0])
def test_column_on_a_plane_slides_like_a_body(backend, slope):
    """g S/(1 + S^2) instead of g S."""
    a = columns([[0, 0]], bed_slope=[[slope], [0]], acceleration=[[-G * slope], [0]], velocity=[[7.0], [3.0]])
    assert run("constrain_to_bed", backend, a)[:, 0] == pytest.approx([-G * slope / (1 + slope**2), 0], rel=1e-12, abs=1e-15)


@everywhere
def test_constrained_column_stays_on_the_bed_and_is_pushed_along_its_normal(backend):
    """z'' follows from b(x(t)); what is not pressure and gravity is normal to the bed."""
    rng = np.random.default_rng(2)
    v, s, K, t = rng.normal(size=(2, 9)), rng.normal(size=(2, 9)), rng.normal(size=(3, 9)), 3 * rng.normal(size=(2, 9))
    a = columns(np.zeros((9, 2)), bed_slope=s, bed_curvature=K, velocity=v, acceleration=-t - G * s)
    found = run("constrain_to_bed", backend, a)
    rise = (s * found).sum(axis=0) + K[0] * v[0] ** 2 + K[1] * v[1] ** 2 + 2 * K[2] * v[0] * v[1]
    push = np.vstack([found + t, rise + G])
    assert push[:2] == pytest.approx(-s * push[2], abs=1e-11)
