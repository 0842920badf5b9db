"""Bubbles on the move: rise, drag and its reaction, exclusion of liquid, drift (boiling V15, V19, section 6)."""

import numpy as np
import pytest
from bubble_cases import (
    BUBBLE,
    BUBBLES,
    FAR,
    INACTIVE,
    INERTIA,
    LIQUID,
    VAPOUR,
    WALL,
    R,
    poly6,
    pool,
    rounding,
    run,
    terminal_speed,
)
from liquid_cases import both, everywhere
from pbf_cases import MASS, D, lattice

A = BUBBLES["rise_z"]
BOX = dict(lower_x=0.0, upper_x=0.1, lower_y=0.0, upper_y=1e30, lower_z=0.0, upper_z=1e30)


@everywhere
@both
def test_prediction_by_hand(backend, precision):
    """v += dt a_B, x += dt v; a radius from the walls, mid-way where there is no room; only what is listed moves."""
    x = [[0.05, 0.03, 0.1], [0.095, 0.03, 0.005], [0.02, 0.05, 0.1], [0.05, 0.5, 0.1], [0.05, 0.7, 0.1]]
    phase, r = [BUBBLE, BUBBLE, BUBBLE, LIQUID, BUBBLE], [0.01, 0.01, 0.06, 0, 0.01]
    a = pool(x, phase, precision, bubble_radius=r, velocity=np.tile([[0.2], [-0.1], [0.4]], 5), bubble_count=[3])
    before = {name: a[name].copy() for name in ("velocity", "position")}
    run("bubble_predict", backend, a, dt=0.01, **BOX)
    rel, _ = rounding(precision)
    assert a["velocity"][:, :3].T == pytest.approx(np.tile([0.2, -0.1, 0.4 + 0.01 * A], (3, 1)), rel=rel)
    z = 0.01 * (0.4 + 0.01 * A)
    want = [[0.052, 0.029, 0.1 + z], [0.09, 0.029, 0.01], [0.05, 0.06, 0.1 + z]]
    want[1][2] = max(0.005 + z, 0.01)
    assert a["position"][:, :3].T == pytest.approx(np.array(want), rel=rel)
    for name, kept in before.items():
        assert (a[name][:, 3:] == kept[:, 3:]).all()


@everywhere
@both
def test_large_bubble_pushes_liquid_out_to_its_radius(backend, precision):
    r = 1.5 * D
    x = [[0, 0, 0], [0.3 * D, 0, 0.4 * D], [0, 1.6 * D, 0], [0, 0, -D], [0, 0, 0], [0, 0.5 * D, 0]]
    a = pool(x, [BUBBLE, LIQUID, LIQUID, LIQUID, LIQUID, WALL], precision, bubble_radius=[r, 0, 0, 0, 0, 0])
    out = run("bubble_exclude", backend, a, vessel=dict(lower_z=-1.2 * D))["position"].T / D
    # radially; outside of it nothing; clamped to the vessel; from the centre straight up; walls stay
    want = [[0, 0, 0], [0.9, 0, 1.2], [0, 1.6, 0], [0, 0, -1.2], [0, 0, 1.5], [0, 0.5, 0]]
    assert out == pytest.approx(np.array(want), abs=rounding(precision)[0])


@everywhere
def test_bubbles_up_to_a_spacing_exclude_nothing_and_several_act_in_turn(backend):
    x = [[0, 0, 0], [2 * D, 0, 0], [0.5 * D, 0, 0], [10 * D, 0, 0], [10.5 * D, 0, 0], [4 * D, 0, 0]]
    phase = [BUBBLE, BUBBLE, LIQUID, BUBBLE, LIQUID, BUBBLE]
    a = pool(x, phase, bubble_radius=np.array([1.5, 1.2, 0, 1.0, 0, 9.0]) * D, bubble_count=[3])
    out = run("bubble_exclude", backend, a)["position"]
    # the first moves it to 1.5 d, into the second one (0.8 to 3.2 d), which moves it to 0.8 d
    assert out[:, 2] / D == pytest.approx([0.8, 0, 0], abs=1e-14)
    assert (out[:, 4] == a["position"][:, 4]).all() and out[0, 4] == 10.5 * D


def drag_by_hand(v, u, r, dt):
    """Velocity after the drag, as the spec writes it."""
    k = BUBBLES["drag"] / r
    s0 = np.sqrt(((v - u) ** 2).sum())
    s1 = (-1 + np.sqrt(1 + 4 * k * dt * s0)) / (2 * k * dt)
    return u + (v - u) * s1 / s0


@everywhere
@both
def test_drag_and_reaction_by_hand(backend, precision):
    """Two liquid neighbours of unequal weight and mass; walls, vapour and a particle exactly at R do not count."""
    x = [[0, 0, 0], [D, 0, 0], [0, 0, 1.5 * D], [0, D, 0], [0, -D, 0], [0, 0, -R], [-D, 0, 0]]
    phase = [BUBBLE, LIQUID, LIQUID, WALL, VAPOUR, LIQUID, BUBBLE]
    v = np.array([[0.1, 0, 0.3], [0, 0.2, -0.1], [0.3, 0, 0.05], [9, 9, 9], [9, 9, 9], [9, 9, 9], [9, 9, 9]])
    m = np.array([1, 1, 2, 1, 1, 1, 1]) * MASS
    a = pool(x, phase, precision, velocity=v.T, mass=m, bubble_radius=np.full(7, 0.4 * D), bubble_count=[1])
    a["bubble_push"][:, 6] = 0
    run("bubble_drag", backend, a, dt=0.004)
    W = np.array([poly6(D), poly6(1.5 * D)])
    u = (W @ v[1:3]) / W.sum()
    after = drag_by_hand(v[0], u, 0.4 * D, 0.004)
    dv, I_b = after - v[0], INERTIA * 4 / 3 * np.pi * (0.4 * D) ** 3
    rel, _ = rounding(precision)
    assert a["velocity"][:, 0] == pytest.approx(after, rel=10 * rel)
    assert a["bubble_push"][:, 0] == pytest.approx(-I_b * dv / W.sum(), rel=10 * rel)
    run("bubble_reaction", backend, a)
    for i, w in ((1, W[0]), (2, W[1])):
        assert a["velocity"][:, i] == pytest.approx(v[i] - I_b * dv * w / W.sum() / m[i], rel=10 * rel, abs=1e-8 * (rel > 1e-9))
    assert (a["velocity"][:, 3:] == 9).all()


@everywhere
@pytest.mark.parametrize("uniform", [1, 0])
@pytest.mark.parametrize("precision", ["single", "mixed", "double"])
def test_drag_conserves_momentum(backend, precision, uniform):
    """Liquid of unequal masses and support radii, bubbles of all sizes, two of them at one place."""
    rng = np.random.default_rng(5)
    n = 203
    x = rng.uniform(0, 1, (n, 3)) * np.array([7, 6, 6]) * D
    phase = np.where(rng.random(n) < 0.2, BUBBLE, LIQUID)
    phase[::31] = INACTIVE
    x[3], phase[[3, 4]] = x[4], BUBBLE
    x[5], phase[5] = x[6], LIQUID
    bubble, liquid = phase == BUBBLE, phase == LIQUID
    radius = np.where(bubble, rng.choice([0.2, 0.39, 1.0, 1.6], n) * D, 0)
    a = pool(
        x, phase, precision, mass=rng.uniform(0.3, 3, n) * MASS, velocity=rng.normal(size=(3, n)), bubble_radius=radius,
        support_radius=np.where(liquid, rng.uniform(1.6, 2.2, n) * D, 0),
    )
    before = a["velocity"].astype(float)
    run("bubble_drag", backend, a, dt=0.004, uniform=uniform)
    run("bubble_reaction", backend, a, uniform=uniform)
    inertia = np.where(liquid, a["mass"], INERTIA * 4 / 3 * np.pi * a["bubble_radius"].astype(float) ** 3)
    handed = inertia * (a["velocity"] - before)
    assert bubble.sum() > 20 and (handed[:, bubble] != 0).all() and (handed[:, phase == INACTIVE] == 0).all()
    error = np.abs(handed.sum(axis=1)).max() / np.abs(handed).sum()
    assert error <= (1e-13 if precision == "double" else 1e-6)


@everywhere
@pytest.mark.parametrize("steps", [60, 240, 960])
@pytest.mark.parametrize("ratio, speed", [(0.2, 0.198), (0.39, 0.277), (0.7, 0.371), (1.0, 0.443)])
def test_terminal_speed_in_frozen_liquid(backend, steps, ratio, speed):
    """V15: the formula of the spec for any time step; a lattice goes by, so the bubble's place is taken modulo d."""
    x = np.vstack([[[2.6 * D, 2.4 * D, 2.5 * D]], lattice(5, 5, 6)])
    r = ratio * D
    a = pool(x, [BUBBLE] + [LIQUID] * (len(x) - 1), reach=R + D, bubble_radius=[r] + [0] * (len(x) - 1))
    dt = 1 / steps
    for _ in range(max(12, int(0.4 * steps))):
        a["position"][2, 0] = 2 * D + (a["position"][2, 0] - 2 * D) % D
        start = a["position"][:, 0].copy()
        a["position_predicted"][:, 0] = start
        run("bubble_predict", backend, a, dt=dt)
        run("bubble_drag", backend, a, dt=dt)
        run("bubble_move", backend, a, dt=dt)
    assert a["velocity"][2, 0] == pytest.approx(terminal_speed(r), rel=1e-6)
    assert terminal_speed(r) == pytest.approx(speed, abs=6e-4)  # the table of V16
    # what moves is the velocity after the drag: that before it is a_B dt faster
    assert a["position"][2, 0] - start[2] == pytest.approx(dt * terminal_speed(r), rel=1e-6)
    assert (a["velocity"][:, 1:] == 0).all() and np.abs(a["velocity"][:2, 0]).max() == 0


@everywhere
def test_weak_drag_keeps_its_digits_in_single_precision(backend):
    """4 k dt s0 from 1e-9 to 1e-2: -1 + sqrt(1 + that) would have no digits left."""
    for s0 in (1e-7, 1e-5, 1e-3, 1e-1):
        a = pool([[0, 0, 0], [D, 0, 0]], [BUBBLE, LIQUID], "single", bubble_radius=[D, 0], velocity=[[0, 0], [s0, 0], [0, 0]])
        run("bubble_drag", backend, a, dt=1e-4)
        c = np.longdouble(4 * BUBBLES["drag"] / D * 1e-4) * s0
        loss = c / (1 + np.sqrt(1 + c)) ** 2
        want = INERTIA * 4 / 3 * np.pi * D**3 * float(loss) * s0 / poly6(D)
        assert a["bubble_push"][1, 0] == pytest.approx(want, rel=2e-6)


@everywhere
@pytest.mark.parametrize("case", ["alone", "with the liquid", "exactly at the support"])
def test_nothing_to_be_dragged_by(backend, case):
    place = {"alone": 5 * D, "with the liquid": D, "exactly at the support": R}[case]
    v = np.array([[0.1, 0.1], [-0.3, -0.3], [0.7, 0.7 if case == "with the liquid" else 0.0]])
    a = pool([[0, 0, 0], [place, 0, 0]], [BUBBLE, LIQUID], bubble_radius=[D, 0], velocity=v, reach=3 * R)
    a["bubble_push"][:] = 7.0
    run("bubble_drag", backend, a, dt=0.004)
    assert (a["velocity"] == v).all() and (a["bubble_push"][:, 0] == 0).all()
    run("bubble_reaction", backend, a)
    assert (a["velocity"] == v).all()


@everywhere
def test_move_starts_from_where_the_bubble_was(backend):
    a = pool([[0.5, 0.5, 0.5]] * 2, BUBBLE, velocity=[[0.1, 9], [0, 0], [0.2, 0]], bubble_radius=[0.01, 0.04])
    a["position_predicted"][:] = np.array([[0.05, 0.05], [0.2, 0.02], [0.3, 0.3]])
    out = run("bubble_move", backend, a, dt=0.01, **BOX)["position"]
    assert out.T == pytest.approx(np.array([[0.051, 0.2, 0.302], [0.06, 0.04, 0.3]]), rel=1e-14)


@everywhere
def test_two_bubbles_approach(backend):
    """V19: each by kappa R per frame along x; equal coordinates count on neither side, nor do liquid and vapour."""
    x = [[0, 0, 0], [D, 0, 0.5 * D], [0, 0.3 * D, D], [0, -0.3 * D, D]]
    a = pool(x, [BUBBLE, BUBBLE, LIQUID, VAPOUR], bubble_radius=[0.4 * D] * 2 + [0, 0])
    for _ in range(2):
        gap = a["position"][0, 1] - a["position"][0, 0]
        shift = run("bubble_drift", backend, a, dt=1 / 60)["bubble_shift"]
        assert shift[:, :2] == pytest.approx(np.array([[0.1 * R, -0.1 * R], [0, 0]]), abs=1e-12 * R)
        run("bubble_shift", backend, a)
        assert a["position"][0, 1] - a["position"][0, 0] == pytest.approx(gap - 0.2 * R, abs=1e-12 * R)


def ring(n):
    """Bubbles at the corners of a regular n-gon around one in the middle, symmetric to the last bit."""
    angle = np.pi / 4 + np.arange(4) * np.pi / 2
    corner = np.round(np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]) * 2**20) / 2**20 * D
    return np.vstack([np.zeros((1, 3)), corner[: n]])


@everywhere
@pytest.mark.parametrize("normalised", [1, 0])
def test_symmetric_ring_stays_centred(backend, normalised):
    """V19."""
    a = pool(ring(4), BUBBLE, bubble_radius=np.full(5, 0.4 * D))
    shift = run("bubble_drift", backend, a, dt=1 / 60, normalised=normalised)["bubble_shift"]
    assert (shift[:, 0] == 0).all() and np.abs(shift.sum(axis=1)).max() <= 1e-12 * R
    # the corner (+, +) has the middle and two corners on its left; (+, -) is straight below it
    left = 1.0 if normalised else 3.0
    assert shift[0, 1] == pytest.approx(-left * 0.1 * R, abs=1e-12 * R)
    run("bubble_shift", backend, a)
    assert np.abs(a["position"][:2].mean(axis=1)).max() <= 1e-12 * R


@everywhere
@pytest.mark.parametrize("normalised", [1, 0])
def test_drift_of_a_cloud(backend, normalised):
    """V19: unnormalised it sums to zero; normalised it is at most kappa R per frame."""
    rng = np.random.default_rng(19)
    x = rng.uniform(0, 5 * D, (101, 3))
    x[20:30, 0] = x[40:50, 0]  # ties
    a = pool(x, np.where(np.arange(101) % 5 == 0, LIQUID, BUBBLE), bubble_radius=np.full(101, 0.4 * D))
    shift = run("bubble_drift", backend, a, dt=1 / 60, normalised=normalised)["bubble_shift"][:, a["phase"] == BUBBLE]
    if normalised:
        assert 0.01 * R < np.abs(shift).mean() and np.abs(shift).max() <= 0.1 * R * (1 + 1e-14)
    else:
        assert np.abs(shift).max() > R and np.abs(shift.sum(axis=1)).max() <= 1e-12 * np.abs(shift).sum()


@everywhere
def test_drift_stays_within_the_walls_and_keeps_the_height(backend):
    a = pool([[0.085, 0.2, 0.001], [0.05, 0.2, 0.1]], BUBBLE, bubble_radius=[0.01, 0.06], bubble_shift=[[0.02, 0.02], [-0.3, 0.01]])
    out = run("bubble_shift", backend, a, **BOX)["position"]
    assert out.T == pytest.approx(np.array([[0.09, 0.01, 0.001], [0.05, 0.21, 0.1]]), rel=1e-14)


STAGES_HERE = [
    "bubble_predict", "bubble_exclude", "bubble_drag", "bubble_reaction", "bubble_move", "bubble_drift", "bubble_shift",
]


@everywhere
@pytest.mark.parametrize("stage", STAGES_HERE)
@pytest.mark.parametrize("n", [0, 3])
def test_without_bubbles_nothing_happens(backend, stage, n):
    a = pool(lattice(1, 1, n)[:n], LIQUID, velocity=np.full((3, n), 0.25))
    before = {name: a[name].copy() for name in ("position", "velocity", "bubble_push", "bubble_shift")}
    run(stage, backend, a, dt=0.004)
    for name, value in before.items():
        assert (a[name] == value).all(), name


@everywhere
def test_bubble_larger_than_the_tank(backend):
    """Section 6: its centre is held mid-tank, liquid in it goes to the walls, and nothing is NaN."""
    sides = {**FAR, "lower_x": 0.0, "upper_x": 4 * D, "lower_y": 0.0, "upper_y": 4 * D, "lower_z": 0.0}
    x = np.vstack([[[0.5 * D, 3 * D, D]], lattice(4)])
    a = pool(x, [BUBBLE] + [LIQUID] * 64, bubble_radius=[5 * D] + [0] * 64)
    for name in ("bubble_predict", "bubble_drag", "bubble_reaction", "bubble_move", "bubble_exclude"):
        run(name, backend, a, dt=0.004, vessel=sides, **sides)
    assert a["position"][:, 0] / D == pytest.approx([2, 2, 5], rel=1e-12)
    assert all(np.isfinite(a[name]).all() for name in ("position", "velocity", "bubble_push"))
    inside = (a["position"][:2, 1:] >= 0) & (a["position"][:2, 1:] <= 4 * D)
    assert inside.all() and (a["position"][2, 1:] >= 0).all()


@everywhere
@both
def test_a_bubble_larger_than_its_support_is_slowed_as_in_liquid_at_rest(backend, precision):
    """No liquid is within R of its centre; without drag it would speed up for ever. A small one in the air is not slowed."""
    r, v = 3 * D, 0.8
    x = np.array([[0, 0, 0], [3.2 * D, 0, 0], [9 * D, 0, 0]])
    a = pool(x, [BUBBLE, LIQUID, BUBBLE], precision, bubble_radius=[r, 0, 0.5 * D], velocity=[[0, 0, 0], [0, 0, 0], [v, 0, v]])
    out = run("bubble_drag", backend, a, dt=0.01)
    k = 3 / 8 * 8 / 3 * 1000 / INERTIA / r
    s1 = (-1 + np.sqrt(1 + 4 * k * 0.01 * v)) / (2 * k * 0.01)
    assert out["velocity"][2] == pytest.approx([s1, 0, v], rel=1e-6)
    assert (out["bubble_push"][:, [0, 2]] == 0).all()
