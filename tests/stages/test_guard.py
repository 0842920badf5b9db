"""Non-penetration guard: counts, corrections, exact momentum."""

import numpy as np
import pytest
from liquid_cases import REALS, both, everywhere, particles, run, tolerance


def guarded(backend, a):
    """Return (offenders, position, velocity) after the guard."""
    a = {**a, "offenders": run("guard_offenders", backend, a)["offenders"]}
    out = run("guard_correction", backend, a)
    return a["offenders"], out["position_next"], out["velocity_next"]


@everywhere
@both
def test_liquid_and_solid_are_pushed_apart_by_inverse_mass(backend, precision):
    a = particles(
        [[0, 0, 0], [0.06, 0, 0]], [0, 1], precision, mass=[1.0, 3.0], velocity=[[2.0, -2], [5, 5], [0, 1]]
    )
    n, x, v = guarded(backend, a)
    assert n.tolist() == [1, 1]
    rel = tolerance(precision)
    assert x == pytest.approx(
        np.array([[-0.75 * 0.04, 0.06 + 0.25 * 0.04], [0, 0], [0, 0]]), rel=rel, abs=1e-8
    )
    assert v == pytest.approx(np.array([[-1, -1], [5, 5], [0, 1]]), rel=rel)  # common normal velocity remains


@everywhere
@both
def test_wall_does_not_give_way(backend, precision):
    a = particles([[0, 0, 0], [0, 0, -0.06]], [0, 2], precision, velocity=[[1.0, 0], [0, 0], [-3, 0]])
    n, x, v = guarded(backend, a)
    assert n.tolist() == [1, 0]
    assert x[2] == pytest.approx([0.04, -0.06], rel=tolerance(precision))
    assert v[:, 0] == pytest.approx([1, 0, 0], abs=1e-6) and (v[:, 1] == 0).all()


@everywhere
@both
def test_parting_velocity_is_kept(backend, precision):
    a = particles([[0, 0, 0], [0.06, 0, 0]], [0, 1], precision, velocity=[[-2.0, 2], [0, 0], [0, 0]])
    _, x, v = guarded(backend, a)
    assert np.array_equal(v, a["velocity"]) and x[0, 0] < 0


@everywhere
@both
def test_at_the_distance_and_same_kind_are_left(backend, precision):
    # liquid at d_min from a solid; two liquids, two solids and a solid at a wall however close
    x = [[0, 0, 0], [0.125, 0, 0], [2, 0, 0], [2.01, 0, 0], [4, 0, 0], [4.01, 0, 0], [6, 0, 0], [6.01, 0, 0]]
    a = particles(x, [0, 1, 0, 0, 1, 1, 1, 2], precision, velocity=np.ones((3, 8)))
    a["offenders"][:] = -1
    out = run("guard_offenders", backend, a, distance=0.125)["offenders"]
    assert (out == 0).all()
    a["offenders"] = out
    moved = run("guard_correction", backend, a, distance=0.125)
    assert np.array_equal(moved["position_next"], a["position"]) and np.array_equal(
        moved["velocity_next"], a["velocity"]
    )


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_momentum_and_centre_of_mass_of_a_crowd(backend, precision):
    rng = np.random.default_rng(1)
    n = 60
    x = rng.uniform(0, 0.4, (n, 3))
    x[0] = x[1]
    a = particles(
        x, np.arange(n) % 2, precision, mass=rng.uniform(0.1, 5, n), velocity=rng.normal(size=(3, n))
    )
    count, position, velocity = guarded(backend, a)
    assert count.max() >= 3
    m, eps = a["mass"].astype(float), np.finfo(a["mass"].dtype).eps
    for before, after in ((a["position"], position), (a["velocity"], velocity)):
        change = (after.astype(float) - before) * m
        assert np.abs(change).max() > 1e-3
        size = (np.abs(after.astype(float)) * m).sum()
        assert np.abs(change.sum(axis=1)).max() <= 4 * eps * size


@everywhere
def test_a_pass_brings_no_pair_closer_than_it_was_for_one_offender(backend):
    # three solids below one liquid: the weights keep the sum of three corrections moderate
    a = particles([[0, 0, 0.03], [0, 0, 0], [0.02, 0, 0], [-0.02, 0, 0]], [0, 1, 1, 1])
    count, x, _ = guarded(backend, a)
    assert count.tolist() == [3, 1, 1, 1]
    assert 0.03 < x[2, 0] < 0.1 and np.isfinite(x).all()


@everywhere
@both
def test_coincident_is_counted_and_finite(backend, precision):
    a = particles([[1, 1, 1], [1, 1, 1]], [0, 1], precision, velocity=[[1.0, 0], [0, 0], [0, 0]])
    count, x, v = guarded(backend, a)
    assert count.tolist() == [1, 1]
    assert np.array_equal(x, a["position"]) and np.array_equal(v, a["velocity"])


@everywhere
def test_empty(backend):
    count, x, v = guarded(backend, particles(np.zeros((0, 3))))
    assert count.size == 0 and x.shape == v.shape == (3, 0)
