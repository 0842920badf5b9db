"""Contact of solids with other solids, themselves and walls."""

import numpy as np
import pytest
from liquid_cases import DX, REALS, both, box, everywhere, particles, run, solid_sites, tolerance

DT = 1e-2
PUSH = 0.25 * 4 / DT**2 * 0.05  # penalty of reduced mass 4 kg, 0.05 m deep


def pair(precision, gap=0.15, component=(0, 1), cells=((0, 0, 0), (9, 0, 0)), **fields):
    """Two solid particles a gap apart along x."""
    return solid_sites(
        particles([[0, 0, 0], [gap, 0, 0]], 1, precision, **fields), cells, np.array(component)
    )


def force(backend, a, **params):
    return run("contact_force", backend, a, dt=DT, **params)["force"]


@everywhere
@both
def test_penalty_of_two_bodies(backend, precision):
    F = force(backend, pair(precision, force=np.ones((3, 2))))
    assert F.T == pytest.approx(np.array([[1 - PUSH, 1, 1], [1 + PUSH, 1, 1]]), rel=tolerance(precision))


@everywhere
@both
def test_no_contact_at_the_distance_or_beyond(backend, precision):
    assert (force(backend, pair(precision, gap=DX)) == 0).all()
    assert (force(backend, pair(precision, gap=0.3)) == 0).all()


@everywhere
@both
def test_wall_is_infinitely_heavy(backend, precision):
    a = solid_sites(particles([[0, 0, 0], [0.15, 0, 0]], [1, 2], precision), [[0, 0, 0]])
    F = force(backend, a)
    assert F.T == pytest.approx(np.array([[-2 * PUSH, 0, 0], [0, 0, 0]]), rel=tolerance(precision))


@everywhere
@both
def test_damping_acts_on_approach_only(backend, precision):
    closing = pair(precision, velocity=[[1.0, -1], [0, 0], [0, 0]])
    F = force(backend, closing, damping=0.1)
    assert F[0, 0] == pytest.approx(-(PUSH + 0.1 * 4 * 2 / DT), rel=tolerance(precision))
    parting = pair(precision, velocity=[[-1.0, 1], [0, 0], [0, 0]])
    assert force(backend, parting, damping=0.1)[0, 0] == pytest.approx(-PUSH, rel=tolerance(precision))


@everywhere
@both
def test_coulomb_friction(backend, precision):
    fast = pair(precision, velocity=[[0.0, 0], [3, -3], [4, -4]])
    F = force(backend, fast, friction=0.2)
    assert F[:, 0] == pytest.approx([-PUSH, -0.2 * PUSH * 0.6, -0.2 * PUSH * 0.8], rel=tolerance(precision))
    slow = pair(precision, velocity=[[0.0, 0], [1e-3, 0], [0, 0]])
    assert force(backend, slow, friction=0.2)[1, 0] == pytest.approx(
        -0.25 * 4 * 1e-3 / DT, rel=tolerance(precision)
    )


@everywhere
def test_one_body_touches_itself_only_where_its_lattice_is_far(backend):
    for step, hits in ((1, False), (2, False), (3, True)):
        for cells in (((0, 0, 0), (step, 0, 0)), ((0, 0, 0), (1, -step, 0))):
            F = force(backend, pair("double", component=(0, 0), cells=cells))
            assert (F[0, 0] != 0) == hits, cells
    # two bodies in adjacent voxels are two bodies
    assert force(backend, pair("double", cells=((0, 0, 0), (1, 0, 0))))[0, 0] != 0


@everywhere
def test_inner_and_liquid_particles_take_no_part(backend):
    a = pair("double")
    a["site_link_count"][1] = 27
    assert (force(backend, a) == 0).all()
    b = solid_sites(particles([[0, 0, 0], [0.15, 0, 0]], [1, 0]), [[0, 0, 0]])
    assert (force(backend, b) == 0).all()


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_equal_and_opposite_to_the_bit_and_momentum(backend, precision):
    rng = np.random.default_rng(0)
    for _ in range(20):
        x = np.vstack([np.zeros(3), rng.uniform(-0.1, 0.1, 3)])
        a = solid_sites(
            particles(x, 1, precision, velocity=rng.normal(size=(3, 2)), mass=rng.uniform(1, 9, 2)),
            [[0, 0, 0], [9, 0, 0]],
            np.array([0, 1]),
        )
        F = force(backend, a, damping=0.1, friction=0.2)
        assert np.array_equal(F[:, 0], -F[:, 1]) and np.abs(F).max() > 0
    # two cubes pressed into each other
    first, second = box(3, 3, 3), box(3, 3, 3, (0.55, 0.03, 0.05))
    cells = np.round(np.vstack([first, first + (2, 0, 0)]) / DX - 0.5).astype(int)
    a = solid_sites(
        particles(np.vstack([first, second]), 1, precision, velocity=rng.normal(size=(3, 54))),
        cells,
        np.repeat([0, 1], 27),
    )
    F = force(backend, a, damping=0.1, friction=0.2).astype(float)
    assert np.abs(F.sum(axis=1)).max() <= 20 * np.finfo(a["mass"].dtype).eps * np.abs(F).sum()
    assert F[0, :27].sum() < 0


@everywhere
def test_coincident_and_empty(backend):
    F = force(backend, pair("double", gap=0.0, velocity=np.ones((3, 2))), damping=0.1, friction=0.2)
    assert (F == 0).all()
    none = solid_sites(particles(np.zeros((0, 3))), np.zeros((0, 3), int))
    assert force(backend, none).shape == (3, 0)


@everywhere
@pytest.mark.parametrize("connect", [6, 18, 26])
def test_who_is_inside_and_what_is_near_follow_the_bonds_of_the_scene(backend, connect):
    """A site with all its bonds takes no part; of one piece, sites within 2 bonds leave each other alone.

    Bonds to the voxel (1, 1, 1): 3, 2, 1 for connect 6, 18, 26; to (2, 1, 1): 4, 2, 2; to (2, 2, 1): 5, 3, 2.
    """
    whole = pair("double")
    whole["site_link_count"][1] = connect + 1
    assert (force(backend, whole, connect=connect) == 0).all()
    whole["site_link_count"][1] = connect
    assert force(backend, whole, connect=connect)[0, 0] == pytest.approx(-PUSH, rel=1e-11)
    for cell, bonds in (((1, 1, 1), (3, 2, 1)), ((2, -1, 1), (4, 2, 2)), ((-2, 2, 1), (5, 3, 2)), ((0, 3, 0), (3,) * 3)):
        a = pair("double", component=(0, 0), cells=((0, 0, 0), cell))
        a["site_link_count"][:] = 2
        hits = dict(zip((6, 18, 26), bonds))[connect] > 2
        assert (force(backend, a, connect=connect)[0, 0] != 0) == hits, cell
