"""Bed friction and the brake, point-implicit (flood E15, E12b)."""

import numpy as np
import pytest
from flood_force_cases import AIRBORNE, INACTIVE, LIQUID, TERRAIN, G, both, columns, everywhere, run

from melt import params as P

LAWS = (P.FRICTION_MANNING, P.FRICTION_CHEZY, P.FRICTION_DARCY)
V = np.array([[3.0, -1.0, 0.2], [4.0, 2.0, -0.1]])


def rate(law, value, d):
    """C of S_f = C |v| v."""
    return {
        P.FRICTION_MANNING: G * value**2 / d ** (4 / 3), P.FRICTION_CHEZY: G / (value**2 * d), P.FRICTION_DARCY: value / (8 * d),
    }[law]


@everywhere
@both
@pytest.mark.parametrize("law, value", list(zip(LAWS, (0.033, 40.0, 0.12))))
def test_each_law_by_hand(backend, precision, law, value):
    d = np.array([0.5, 2.0, 1e-5])
    a = columns(np.zeros((3, 2)), precision, velocity=V, depth=d)
    found = run("flood_drag", backend, a, law=law, value=value, thinnest=1e-3, dt=0.1)
    C = rate(law, value, np.maximum(d, 1e-3))
    expected = V / (1 + 0.1 * C * np.hypot(*V))
    assert found[:2] == pytest.approx(expected, rel=2e-6 if precision == "single" else 1e-12)
    assert (found[2] == 0).all()


@everywhere
@pytest.mark.parametrize("law", LAWS)
def test_decay_is_exact_and_never_reverses(backend, law):
    """dv/dt = -C v^2 has the solution v/(1 + C v t): ten steps are as good as one, and one of a year stops at 0."""
    d = np.array([0.5, 2.0, 1e-2])
    a = columns(np.zeros((3, 2)), velocity=V, depth=d)
    for _ in range(10):
        run("flood_drag", backend, a, law=law, value=0.5, dt=0.3)
    expected = V / (1 + 3.0 * rate(law, 0.5, d) * np.hypot(*V))
    assert a["velocity"][:2] == pytest.approx(expected, rel=1e-12)
    found = run("flood_drag", backend, a, law=law, value=0.5, dt=3e7)
    assert (found[:2] * V >= 0).all() and np.hypot(*found[:2]).max() < 1e-5


@everywhere
def test_friction_of_the_nearest_node(backend):
    """Outside the terrain that of its edge."""
    values = np.random.default_rng(1).uniform(0.02, 0.06, TERRAIN["nx"] * TERRAIN["ny"])
    x = [[0.4, -0.4], [-19.6, 3.6], [35.0, -99.0]]
    a = columns(x, velocity=V, terrain_friction=values, rest_volume=np.ones(3))
    found = run("flood_drag", backend, a, mapped=1, value=9.0, dt=0.2)
    n = values.reshape(TERRAIN["ny"], TERRAIN["nx"])[[20, 24, 0], [20, 0, 40]]
    assert found[:2] == pytest.approx(V / (1 + 0.2 * G * n**2 * np.hypot(*V)), rel=1e-12)


@everywhere
@both
def test_brake_stops_and_never_reverses(backend, precision):
    """E12b: v max(0, 1 - a dt/|v|); a bead that is pushed gains half its speed at most."""
    v = np.array([[3.0, 3.0, 3.0, 3.0, 0.0], [4.0, 4.0, 4.0, 4.0, 0.0]])
    brake = [10.0, 60.0, -10.0, -60.0, 5.0]
    a = columns(np.zeros((5, 2)), precision, velocity=v, brake=brake)
    found = run("flood_drag", backend, a, dt=0.1, control=1)
    assert found[:2] == pytest.approx(v * [0.8, 0, 1.2, 1.5, 1], rel=1e-6 if precision == "single" else 1e-12)
    assert (found[:, 1] == 0).all() and (found[:, 4] == 0).all()
    a = columns(np.zeros((5, 2)), precision, velocity=v, brake=brake)
    assert (run("flood_drag", backend, a, dt=0.1, control=0)[:2] == v).all()


@everywhere
@both
def test_brake_follows_friction(backend, precision):
    a = columns([[0, 0]], precision, velocity=[[3.0], [4.0]], brake=[10.0])
    left = 5 / (1 + 0.1 * G * 0.05**2 * 5) - 10 * 0.1
    found = run("flood_drag", backend, a, value=0.05, dt=0.1, control=1)
    assert np.hypot(*found[:2, 0]) == pytest.approx(left, rel=1e-6 if precision == "single" else 1e-12)


@everywhere
@both
def test_no_brake_changes_no_bit(backend, precision):
    """VC1: with friction off, and with friction on."""
    rng = np.random.default_rng(2)
    for value in (0.0, 0.03):
        a = columns(rng.normal(size=(99, 2)), precision, velocity=rng.normal(size=(2, 99)) * 3)
        before = a["velocity"].astype(float)
        off = run("flood_drag", backend, {**a}, value=value, dt=0.01, control=0)
        on = run("flood_drag", backend, {**a}, value=value, dt=0.01, control=1)
        assert (on == off).all() and (value > 0 or (on == before).all())


@everywhere
def test_columns_that_fall_or_wait_keep_their_velocity(backend):
    v = np.vstack([V, [-5.0, -6.0, 0.0]])
    a = columns(np.zeros((3, 2)), phase=[AIRBORNE, INACTIVE, LIQUID], velocity=v, brake=np.ones(3))
    found = run("flood_drag", backend, a, value=0.1, dt=0.1, control=1)
    assert (found[:, :2] == v[:, :2]).all() and (found[:2, 2] != v[:2, 2]).all()


@everywhere
def test_nan_does_not_hide(backend):
    for field in ("depth", "brake", "velocity"):
        a = columns(np.zeros((2, 2)), velocity=np.ones((2, 2)))
        a[field][..., 1] = np.nan
        found = run("flood_drag", backend, a, value=0.1, dt=0.1, control=1)
        assert np.isfinite(found[:, 0]).all() and np.isnan(found[:2, 1]).all()


@everywhere
def test_no_columns(backend):
    assert run("flood_drag", backend, columns(np.zeros((0, 2))), dt=0.1).shape == (3, 0)
