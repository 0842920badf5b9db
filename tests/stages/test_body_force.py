"""Buoyancy, ambient drag, cohesion."""

import numpy as np
import pytest
from liquid_cases import DX, both, box, everywhere, particles, run, tolerance

W1 = 8.63765707


@everywhere
@both
def test_buoyancy(backend, precision):
    a = particles(
        np.arange(9).reshape(3, 3),
        [0, 0, 1],
        precision,
        temperature=[70.0, 20, 70],
        mass=[2.0, 1, 1],
        force=np.ones((3, 3)),
    )
    F = run("buoyancy", backend, a, expansion=2e-4, reference_temperature=20, gravity_y=3, gravity_z=-10)[
        "force"
    ]
    warm = 2 * 2e-4 * 50
    assert F.T == pytest.approx(
        np.array([[1, 1 - 3 * warm, 1 + 10 * warm], [1, 1, 1], [1, 1, 1]]), rel=tolerance(precision)
    )


@everywhere
@both
def test_drag(backend, precision):
    a = particles(
        np.arange(6).reshape(2, 3),
        [0, 1],
        precision,
        velocity=[[1.0, 1], [-2, 1], [3, 1]],
        force=np.ones((3, 2)),
    )
    F = run("drag", backend, a, drag=0.25)["force"]
    assert F.T == pytest.approx(np.array([[-1, 5, -5], [1, 1, 1]]), rel=tolerance(precision))


@everywhere
@both
def test_cohesion_of_a_pair(backend, precision):
    a = particles([[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0]], [0, 0, 1], precision, mass=[8.0, 2, 5])
    F = run("surface_tension", backend, a, surface_tension=0.5)["force"]
    size = 0.5 * 8 * 2 * W1 * 0.2
    assert F.T == pytest.approx(
        np.array([[size, 0, 0], [-size, 0, 0], [0, 0, 0]]), rel=tolerance(precision) + 1e-8
    )


@everywhere
@both
def test_cohesion_pulls_the_surface_inwards_and_closes(backend, precision):
    x = box(5, 5, 5)
    F = run("surface_tension", backend, particles(x, 0, precision), surface_tension=1)["force"].astype(float)
    size = np.abs(F).max()
    near = (1e-5 if precision == "single" else 1e-12) * size
    assert np.abs(F.sum(axis=1)).max() < 125 * near
    assert np.abs(F[:, 62]).max() < near  # the centre
    assert (F * (x.T - 2.5 * DX)).sum(axis=0).max() <= near


@everywhere
def test_empty(backend):
    none = particles(np.zeros((0, 3)))
    for stage in ("buoyancy", "drag", "surface_tension"):
        assert run(stage, backend, none)["force"].shape == (3, 0)
