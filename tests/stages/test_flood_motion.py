"""Kick, drift, landing and damping of columns."""

import numpy as np
import pytest
from flood_motion_cases import AIRBORNE, INACTIVE, LIQUID, arrays, run
from liquid_cases import BACKENDS, REALS, everywhere

WATER, FALLING, SLOT = [1.0, 1.0, 3.0], [2.0, 1.0, 4.0], [3.0, 1.0, 5.0]


def three(precision="double", **fields):
    """A liquid column, an airborne one and a free slot, all moving."""
    v = np.array([[0.25, 0.5, 0.0], [1.0, -0.5, 2.0], [9.0, 9.0, 9.0]]).T
    return arrays([WATER, FALLING, SLOT], [LIQUID, AIRBORNE, INACTIVE], precision, **{"velocity": v, **fields})


@everywhere
def test_kick_pushes_water_along_the_plane_and_pulls_what_falls_down(backend):
    a = three(acceleration=np.array([[2.0, -4.0], [100.0, 100.0], [100.0, 100.0]]).T)
    v = run("flood_kick", backend, a, dt=0.125)["velocity"]
    assert v.T == pytest.approx(np.array([[0.5, 0.0, 0.0], [1.0, -0.5, 2.0 - 0.125 * 9.81], [9.0, 9.0, 9.0]]), rel=1e-15)


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_drift_moves_and_remembers(backend, precision):
    a = three(precision, position_before=np.full((3, 3), -1.0))
    before = a["position"].copy()
    run("flood_drift", backend, a, dt=0.25)
    assert (a["position_before"][:, :2] == before[:, :2]).all() and (a["position_before"][:, 2] == -1).all()
    # all numbers are exact in float32; the surface of water is none of this stage's business
    assert (a["position"].T == [[1.0625, 1.125, 3.0], [2.25, 0.875, 4.5], SLOT]).all()


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_a_long_move_is_cut_and_keeps_its_direction(backend, precision):
    v = np.array([[3.0, 4.0, 0.0], [-30.0, 40.0, -8.0], [0.3, -0.4, 0.0]]).T
    a = arrays(np.zeros((3, 3)), [LIQUID, AIRBORNE, LIQUID], precision, velocity=v)
    run("flood_drift", backend, a, dt=1.0)
    # 5 m, and 50 m of a falling column, become 0.5 m; a fall is not cut, and half a metre is not too long
    assert a["position"].T == pytest.approx(np.array([[0.3, 0.4, 0], [-0.3, 0.4, -8], [0.3, -0.4, 0]]), rel=2e-7)
    assert (a["velocity"] == v.astype(a["velocity"].dtype)).all()


@everywhere
def test_what_is_not_finite_shows(backend):
    a = arrays(np.zeros((3, 3)), velocity=np.array([[np.nan, 0, 0], [np.inf, 1, 0], [0, 1, 0]]).T)
    run("flood_drift", backend, a, dt=0.1)
    assert np.isnan(a["position"][0, :2]).all() and np.isfinite(a["position"][:, 2]).all()


@everywhere
def test_landing_takes_the_fall_and_nothing_else(backend):
    """At or below the surface under it: bed 1 m and 0.5 m of water."""
    z = [1.75, 1.5, 1.25, np.nan, 1.0, 0.0]
    phase = [AIRBORNE, AIRBORNE, AIRBORNE, AIRBORNE, LIQUID, INACTIVE]
    v = np.tile([[1.0], [2.0], [-3.0]], 6)
    a = arrays(np.column_stack([np.zeros(6), np.zeros(6), z]), phase, bed=np.ones(6), depth=np.full(6, 0.5), velocity=v)
    run("flood_land", backend, a)
    assert a["phase"].tolist() == [AIRBORNE, LIQUID, LIQUID, AIRBORNE, LIQUID, INACTIVE]
    assert a["velocity"][2].tolist() == [-3, 0, 0, -3, -3, -3]
    assert (a["velocity"][:2] == v[:2]).all()


@everywhere
def test_a_column_lands_when_free_fall_says(backend):
    """Thrown up with 2 m/s from 3 m over a pool of 1 m: t = (2 + sqrt(4 + 4 g))/g, a step or two late or early."""
    a = arrays([[1, 1, 3.0]], AIRBORNE, depth=[1.0], velocity=[[0.5], [0], [2.0]])
    dt, steps = 2e-3, 0
    while a["phase"][0] == AIRBORNE and steps < 1000:
        run("flood_kick", backend, a, dt=dt if steps else dt / 2)
        run("flood_drift", backend, a, dt=dt)
        run("flood_land", backend, a)
        steps += 1
    t = (2 + np.sqrt(4 + 4 * 9.81)) / 9.81
    assert steps * dt == pytest.approx(t, abs=1.5 * dt)
    assert a["position"][0, 0] == pytest.approx(1 + 0.5 * steps * dt, rel=1e-12)


@everywhere
def test_damping_is_for_water(backend):
    a = three()
    v = a["velocity"].copy()
    run("damp_columns", backend, a, factor=0.5)
    assert (a["velocity"][:, 0] == 0.5 * v[:, 0]).all() and (a["velocity"][:, 1:] == v[:, 1:]).all()
    run("damp_columns", backend, a, factor=0.0)
    assert (a["velocity"][:, 0] == 0).all()


@pytest.mark.parametrize("backend", BACKENDS)
def test_nothing_is_fine(backend):
    a = arrays(np.zeros((0, 3)))
    run("flood_kick", backend, a, dt=0.1)
    run("flood_drift", backend, a, dt=0.1)
    run("flood_land", backend, a)
    run("damp_columns", backend, a, factor=0.5)
