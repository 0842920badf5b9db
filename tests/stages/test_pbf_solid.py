"""Solids in the position based fluid: they get the opposite of each push, and touch walls and each other (ADR 20)."""

import numpy as np
import pytest
from liquid_cases import both, everywhere, tolerance
from pbf_cases import MASS, D, arrays, d0, pbf_tuple, run

LIQUID, SOLID, WALL = 0, 1, 2


def solids(x, phase, precision, component, **fields):
    """Particles of which the solid ones stand at sites of their own, of the given components."""
    phase = np.asarray(phase)
    on = np.flatnonzero(phase == SOLID)
    site = np.full(phase.size, -1)
    site[on] = np.arange(on.size)
    pad = (0, phase.size - on.size)
    return arrays(
        x, phase, precision, site=site, site_component=np.pad(component, (0, phase.size - len(component))),
        solid_index=np.pad(on, pad, constant_values=-1), solid_count=[on.size], **fields,
    )


@everywhere
@both
def test_a_solid_gets_the_opposite_of_what_it_does_to_the_liquid(backend, precision):
    rng = np.random.default_rng(3)
    phase = np.repeat([LIQUID, SOLID], [20, 6])
    x = rng.uniform(0, 2 * D, (26, 3))
    mass = MASS * np.where(phase == SOLID, 0.917, rng.uniform(0.9, 1.1, 26))
    a = solids(x, phase, precision, [0] * 6, mass=mass, mobility=np.where(phase == LIQUID, 1 / mass, 0.0))
    pbf = pbf_tuple(push=0.1 / d0(2.2), real=a["mass"].dtype.type)
    run("pbf_lambda", backend, a, pbf)
    assert (a["multiplier"][phase == LIQUID] < 0).any() and (a["multiplier"][phase == SOLID] == 0).all()
    run("pbf_correction", backend, a, pbf, iteration=0)
    run("solid_correction", backend, a, pbf)
    moved = a["mass"] * a["correction"]
    assert np.abs(moved[:, phase == SOLID]).max() > 0.01 * MASS * D
    assert np.abs(moved.sum(axis=1)).max() < 30 * tolerance(precision) * np.abs(moved).sum()


@everywhere
@both
def test_bodies_and_walls_closer_than_a_spacing_are_pushed_apart(backend, precision):
    """Half of what is missing: shared by mass between bodies, whole against a wall; not within a body, nor beyond d."""
    x = np.array([[0, 0, 0], [0.6, 0, 0], [0, 0, 0.8], [-0.7, 0, 0], [0, -1.2, 0]]) * D
    phase = [SOLID, SOLID, WALL, SOLID, SOLID]
    a = solids(x, phase, precision, [0, 1, 0, 3], mass=MASS * np.array([1, 3, 1, 1, 1]))
    moved = run("solid_correction", backend, a)["correction"].T / D
    assert moved[0] == pytest.approx([-0.2 * 0.75, 0, -0.1], rel=tolerance(precision), abs=tolerance(precision))
    assert moved[1, 0] == pytest.approx(0.2 * 0.25, rel=tolerance(precision))
