"""Kick, goal kick, drift, leaving the domain, bounds of motion."""

import numpy as np
import pytest
from liquid_cases import REALS, both, everywhere, particles, run, solid_sites, tolerance


def four(precision, **fields):
    """One particle each: liquid, solid, wall, inactive."""
    return particles(np.arange(12).reshape(4, 3), [0, 1, 2, 5], precision, **fields)


@everywhere
@both
def test_kick_moves_liquid_and_solids(backend, precision):
    a = four(precision, velocity=np.ones((3, 4)), force=np.tile([[8.0], [-16], [4]], 4), mass=[8.0, 4, 1, 0])
    v = run("kick", backend, a, dt=0.5)["velocity"]
    assert v.T == pytest.approx(
        np.array([[1.5, 0, 1.25], [2, -1, 1.5], [1, 1, 1], [1, 1, 1]]), rel=tolerance(precision)
    )


@everywhere
@both
def test_goal_kick(backend, precision):
    a = solid_sites(particles(np.arange(9).reshape(3, 3), [0, 1, 1], precision), [[0, 0, 0], [1, 0, 0]])
    a["goal"][:] = [[0.1, 9], [0.2, 9], [-0.1, 9]]
    a["site_particle"][1] = -1
    v = run("goal_kick", backend, a, dt=0.01, stiffness=0.5)["velocity"]
    assert v.T == pytest.approx(np.array([[0, 0, 0], [5, 10, -5], [0, 0, 0]]), rel=tolerance(precision))


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_drift(backend, precision):
    a = four(precision, velocity=np.tile([[1.0], [2], [-4]], 4))
    x = run("drift", backend, a, dt=0.25)["position"]
    moved = a["position"] + np.outer([0.25, 0.5, -1], [1, 1, 0, 0])
    assert x == pytest.approx(moved, rel=1e-6)
    assert x.dtype == a["position"].dtype


@everywhere
def test_mixed_positions_keep_small_steps(backend):
    a = particles([[1000.0, 0, 0]], 0, "mixed", velocity=[[1.0], [0], [0]])
    for _ in range(10):
        a["position"] = run("drift", backend, a, dt=1e-6)["position"]
    assert a["position"][0, 0] - 1000 == pytest.approx(1e-5, rel=1e-4)  # float32 would not move at all


@everywhere
@both
def test_free_fall_is_exact(backend, precision):
    a = particles([[0.0, 0, 0]], 0, precision)
    dt, steps = 2.0**-8, 64  # exact in binary
    g = dict(gravity_z=-8)
    for k in range(steps):
        a["force"] = run("fluid_force", backend, a, alpha=0.2, **g)["force"]
        a["velocity"] = run("kick", backend, a, dt=dt / 2 if k == 0 else dt)["velocity"]
        a["position"] = run("drift", backend, a, dt=dt)["position"]
    assert a["position"][2, 0] == -8 * (steps * dt) ** 2 / 2
    assert (a["position"][:2] == 0).all()


@everywhere
@both
def test_leaving_the_domain(backend, precision):
    x = np.full((8, 3), 0.5)
    x[1, 0], x[2, 1], x[3, 2], x[4, 0], x[5, 2], x[6] = -0.1, 1.1, np.nan, np.inf, 1.0, 2.0
    x[7] = 2.0
    a = particles(np.where(np.isfinite(x), x, 0), [0, 0, 0, 0, 0, 0, 1, 2], precision)
    a["position"][:] = x.T
    # what has no finite position stays, for the host to report
    assert run("leave_domain", backend, a)["phase"].tolist() == [0, 5, 5, 0, 0, 0, 1, 2]
    assert np.array_equal(run("leave_domain", backend, a, delete=0)["phase"], a["phase"])


@everywhere
@both
def test_motion_bounds(backend, precision):
    n = 200
    rng = np.random.default_rng(0)
    a = particles(np.arange(3 * n).reshape(n, 3), rng.choice([0, 1, 2, 5], n), precision)
    a["phase"][[0, 1, 199]] = 0, 1, 2
    a["velocity"][:, 0] = 3, 4, 12
    a["force"][:, 1] = 8 * 2, 8 * 3, 8 * 6
    a["velocity"][:, 199] = a["force"][:, 199] = 1e6  # a wall
    bounds = run("motion_bounds", backend, a)["motion_bounds"]
    assert bounds.shape == (2, 64)
    assert bounds.max(axis=1) == pytest.approx([13, 7], rel=tolerance(precision))
    assert (bounds[:, 1:] == 0).all()


@everywhere
@both
@pytest.mark.parametrize("field, row", (("velocity", 0), ("force", 1)))
def test_a_nan_shows_in_the_bounds(backend, precision, field, row):
    a = particles(
        np.arange(30).reshape(10, 3), 0, precision, velocity=np.ones((3, 10)), force=np.ones((3, 10))
    )
    a[field][1, 4] = np.nan
    a["neighbour_count"][:] = 0
    top = run("motion_bounds", backend, a)["motion_bounds"].max(axis=1)
    assert np.isinf(top[row]) and np.isfinite(top[1 - row])


@everywhere
def test_a_nan_before_larger_values_of_the_same_piece_shows(backend):
    n = 640  # ten particles a piece
    a = particles(np.zeros((1, 3)))
    a = {k: np.repeat(v, n, axis=-1) if v.shape[-1] == 1 else v for k, v in a.items()}
    a["velocity"] = np.ones((3, n))
    a["velocity"][0, 325], a["velocity"][0, 326] = np.nan, 100
    assert np.isinf(run("motion_bounds", backend, a)["motion_bounds"][0, 32])


@everywhere
def test_empty(backend):
    none = solid_sites(particles(np.zeros((0, 3))), np.zeros((0, 3), int))
    for stage in ("kick", "goal_kick", "drift", "leave_domain"):
        run(stage, backend, none, dt=0.1)
    assert (run("motion_bounds", backend, none)["motion_bounds"] == 0).all()
