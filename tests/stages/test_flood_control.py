"""Terrain velocity control force: what flat ground, planes, steps and direction do (flood E11-E13, VC1, VC3-VC6)."""

import numpy as np
import pytest
from flood_force_cases import AIRBORNE, INACTIVE, LIQUID, TERRAIN, G, both, columns, everywhere, nodes, run

from melt import params as P

MODES = (P.CONTROL_PAPER, P.CONTROL_DESCENT, P.CONTROL_BEAD)


def moved(x, by, terrain, precision="double", **fields):
    """Columns at x (n, 2) that came there by a move ``by``."""
    x = np.asarray(x, float).reshape(-1, 2)
    before = (x - np.asarray(by, float)).T
    return columns(x, precision, position_before=before, terrain=terrain, brake=np.full(len(x), 7.0), **fields)


def beta(s, on=0.0, full=0.0):
    t = np.clip((s - on) / (full - on), 0, 1) if full > on else 1.0
    return t**2 * (3 - 2 * t) * s**2 / (1 + s**2)


@everywhere
@both
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("height", [0.0, 7.3, 913.1])
def test_flat_ground_does_not_brake_at_all(backend, precision, mode, height):
    """VC1, bit by bit: at any height, beside a cliff out of reach, off the edge of the terrain."""
    terrain = nodes(lambda x, y: np.where(x > 8, 0.1, height))
    x = [[0.37, 0.91], [-3.3, 5.21], [-30, 2], [-19.9, -19.9]]
    a = moved(x, [[0.01, 0.02], [0.7, -0.3], [0.1, 0.1], [-2, 1]], terrain, precision)
    found = run("control_brake", backend, a, mode=mode)
    if backend == "reference":  # its sampler weighs heights, that of the twins differences of heights
        assert np.abs(found).max() < 1e-30
    else:
        assert found.tobytes() == np.zeros(4).tobytes()


@everywhere
@both
def test_column_that_did_not_move_is_not_braked(backend, precision):
    """VC3; and none that falls or waits."""
    terrain = nodes(lambda x, y: -x)
    a = moved(np.zeros((5, 2)), [[0, 0], [1e-8, 0], [0.1, 0], [0.1, 0], [0.1, 0]], terrain, precision, phase=[0, 0, 0, AIRBORNE, INACTIVE])
    assert (run("control_brake", backend, a) != 0).tolist() == [False, False, True, False, False]


@everywhere
@both
@pytest.mark.parametrize("slope, left", [(1.0, 4.905), (3.0, 2.943)])
def test_drive_of_a_bead_on_a_plane(backend, precision, slope, left):
    """VC4: g S/(1 + S^2) is left of g S, whatever the move and the supports; and so a column runs, by drag and kicks."""
    turn = np.array([np.cos(0.4), np.sin(0.4)])
    terrain = nodes(lambda x, y: -slope * (turn[0] * x + turn[1] * y) + 99)
    a = moved([[0, 0]] * 3, np.outer([1e-4, 0.05, 3.0], turn), terrain, precision, support_radius=[0.5, 2.0, 4.0])
    found = run("control_brake", backend, a)
    assert G * slope - found == pytest.approx(np.full(3, left), rel=1e-12 if precision == "double" else 1e-4)
    a, dt, v, x = moved([[0, 0]], [[0, 0]], terrain, precision), 0.01, np.zeros(2), np.zeros(2)
    a["brake"][:] = 0
    for _ in range(50):
        a["velocity"][:2, 0] = v + dt * G * slope * turn
        run("flood_drag", backend, a, dt=dt, control=1)
        v = a["velocity"][:2, 0].astype(float)
        a["position_before"][:2, 0], a["position"][:2, 0] = x, x + dt * v
        x = x + dt * v
        run("control_brake", backend, a)
    # the first kick has no brake yet, and is kept
    assert v == pytest.approx((0.49 * left + 0.01 * G * slope) * turn, rel=0.01)


@everywhere
def test_uphill_each_mode_does_what_it_says(backend):
    """The paper's brakes both ways, descent only downhill, a bead gets back uphill what it lost."""
    terrain = nodes(lambda x, y: -0.8 * x)
    down_and_up = moved([[0, 0], [0, 0]], [[0.1, 0], [-0.1, 0]], terrain)
    f = G * 0.8 * beta(0.8)
    for mode, expected in zip(MODES, ([f, f], [f, 0], [f, -f])):
        assert run("control_brake", backend, down_and_up, mode=mode) == pytest.approx(expected, rel=1e-12)


@everywhere
def test_slopes_below_the_threshold_do_not_brake(backend):
    """VC2 bit by bit; between the thresholds the smoothstep; across a slope nothing."""
    for slope, on, full in ((0.29, 0.3, 0.6), (0.45, 0.3, 0.6), (0.7, 0.3, 0.6), (0.2, 0.0, 0.0), (0.2, 0.1, 0.1)):
        terrain = nodes(lambda x, y, s=slope: -s * x)
        a = moved([[0, 0], [0, 0]], [[0.1, 0], [0, 0.1]], terrain)
        found = run("control_brake", backend, a, slope_on=on, slope_full=full)
        assert found == pytest.approx([G * slope * beta(slope, on, full), 0], rel=1e-11)
        assert found[1] < 1e-30 and (slope > 0.3 or full == on or found[0] == 0)


@everywhere
def test_mean_of_the_corners_of_a_square_as_wide_as_it_may_be(backend):
    """E12, E13: two corners beyond the edge of a plateau brake by half; the longest side keeps them on it."""
    terrain = nodes(lambda x, y: -2 * np.maximum(x, 0))
    a = moved([[-1.5, 0]], [[0.5, 0]], terrain, support_radius=[2.0])
    f = G * 2 * beta(2.0)
    bilinear = dict(sampler=P.SAMPLER_BILINEAR)
    assert run("control_brake", backend, a, **bilinear) == pytest.approx([f / 2], rel=1e-12)  # x = -3.5, 0.5
    assert run("control_brake", backend, a, longest=0.9, **bilinear) == [0]
    assert run("control_brake", backend, a, spread=0.4, **bilinear) == [0]  # the probes end at -1.5 + 0.8 + 0.5
    assert run("control_brake", backend, a, spread=0.4, shortest=1.5, **bilinear) == pytest.approx([f / 2], rel=1e-12)
    # a third of the probe lies beyond the edge
    s = 2 * (0.5 / 3) / 0.5
    found = run("control_brake", backend, a, spread=0.5 * (1 + 1 / 6), **bilinear)
    assert found == pytest.approx([G * s * beta(s) / 2], rel=1e-12)


@everywhere
def test_long_moves_are_probed_as_a_whole(backend):
    """E11: |Delta| where it is longer than the least probe."""
    terrain = nodes(lambda x, y: -np.maximum(x - 1, 0))
    for move, s in ((0.25, 0.0), (1.0, 0.0), (2.0, 0.5), (4.0, 0.75)):
        a = moved([[0, 0]], [[move, 0]], terrain)
        found = run("control_brake", backend, a, longest=0.0, probe=0.5, sampler=P.SAMPLER_BILINEAR)
        assert found == pytest.approx([G * s * beta(s)], rel=1e-12)


@everywhere
def test_step_halved_changes_little(backend):
    """VC5: there is no dt in it, on a smooth bed."""
    terrain = nodes(lambda x, y: 6 * np.cos(x / 4) + 2 * np.sin(y / 5))
    x = np.random.default_rng(5).uniform(-12, 12, (40, 2))
    by = np.random.default_rng(6).normal(size=(40, 2)) * 0.2
    whole, half = (run("control_brake", backend, moved(x, f * by, terrain), mode=P.CONTROL_BEAD) for f in (1, 0.5))
    assert np.abs(whole - half).max() <= 0.01 * np.abs(whole).max()
    assert np.abs(whole).max() > 1


@everywhere
@pytest.mark.parametrize("mode", MODES)
def test_only_the_bead_ever_gains_speed(backend, mode):
    """VC6."""
    rng = np.random.default_rng(7)
    terrain = 4 * rng.normal(size=TERRAIN["nx"] * TERRAIN["ny"])
    a = moved(rng.uniform(-15, 15, (80, 2)), rng.normal(size=(80, 2)) * 0.3, terrain, velocity=rng.normal(size=(2, 80)))
    before = np.hypot(*a["velocity"][:2])
    run("control_brake", backend, a, mode=mode)
    run("flood_drag", backend, a, dt=0.05, control=1)
    after = np.hypot(*a["velocity"][:2])
    assert (after <= before * (1 if mode != P.CONTROL_BEAD else 1.5) * (1 + 1e-15)).all()
    assert (after > before * (1 + 1e-9)).any() == (mode == P.CONTROL_BEAD) and (after < 0.9 * before).any()


@everywhere
def test_no_columns(backend):
    assert run("control_brake", backend, moved(np.zeros((0, 2)), np.zeros((0, 2)), nodes(lambda x, y: x))).shape == (0,)


@everywhere
def test_nan_does_not_hide(backend):
    a = moved([[0, 0], [1, 1]], [[0.1, 0], [0.1, 0]], nodes(lambda x, y: x), phase=LIQUID)
    a["position_before"][0, 1] = np.nan
    assert np.isnan(run("control_brake", backend, a)).tolist() == [False, True]
