"""Volumes of liquid, walls and solids in SPH sums."""

import numpy as np
import pytest
from liquid_cases import DX, both, box, everywhere, particles, run, solid_sites, tolerance

from melt import params as P
from melt.geometry.lattice import links
from melt.reference._pairs import W

V0 = DX**3


def body(n, precision, scale=1.0):
    """A cube of n^3 solid particles at rest, stretched by ``scale``."""
    x = box(n, n, n)
    cells = np.round(x / DX - 0.5).astype(int)
    return solid_sites(particles(x * scale, 1, precision), cells), cells


@everywhere
@both
def test_liquid_volume_by_phase(backend, precision):
    rest = np.array([1, 2, 3, 4, 5, 6]) * 1e-3
    a = particles(np.arange(18).reshape(6, 3), np.arange(6), precision, rest_volume=rest)
    number = run("liquid_volume", backend, a, number_density=1)["volume"]
    assert np.array_equal(number, np.array([V0, 2e-3, 3e-3, 0, 0, 0], number.dtype))
    volume = run("liquid_volume", backend, a, number_density=0)["volume"]
    assert np.array_equal(volume, np.array([1e-3, 2e-3, 3e-3, 0, 0, 0], volume.dtype))


@everywhere
@both
def test_rest_sum_of_two_sites(backend, precision):
    a = solid_sites(
        particles([[0.1, 0.1, 0.1], [0.3, 0.1, 0.1], [5, 5, 5]], 1, precision),
        [[0, 0, 0], [1, 0, 0], [9, 9, 9]],
    )
    a["site_region_count"][2] = 0  # a dead site
    S = run("rest_sum", backend, a)["rest_sum"]
    assert S[:2] == pytest.approx([20.3718327 + 8.63765707] * 2, rel=1e-6)
    assert S[2] == 0


@everywhere
@both
def test_rest_volume_is_kept_everywhere_in_an_undeformed_body(backend, precision):
    a, _ = body(4, precision)
    a["rest_sum"] = run("rest_sum", backend, a)["rest_sum"]
    V = run("solid_volume_rest", backend, a, solid_scale=0.77)["volume"]
    assert V == pytest.approx(0.77 * V0, rel=tolerance(precision))  # corners and edges too


@everywhere
@both
def test_rest_volume_grows_and_shrinks_with_the_body(backend, precision):
    for scale in (0.9, 1.1):
        a, _ = body(3, precision, scale)
        a["rest_sum"] = run("rest_sum", backend, a)["rest_sum"]
        V = run("solid_volume_rest", backend, a)["volume"]
        assert ((V > V0) if scale > 1 else (V < V0)).all()
    a = solid_sites(particles([[0, 0, 0], [0.3, 0, 0]], 1, precision), [[0, 0, 0], [1, 0, 0]])
    a["rest_sum"] = run("rest_sum", backend, a)["rest_sum"]
    s = P.Smoothing(0.5, 0, 0)
    expected = V0 * (W(0, s) + W(0.2, s)) / (W(0, s) + W(0.3, s))
    assert run("solid_volume_rest", backend, a)["volume"] == pytest.approx(expected, rel=tolerance(precision))


@everywhere
def test_rest_volume_of_others_is_left_alone(backend):
    a = solid_sites(
        particles([[0, 0, 0], [0.2, 0, 0], [0.4, 0, 0]], [0, 1, 2], volume=[1.0, 2.0, 3.0]), [[0, 0, 0]]
    )
    a["rest_sum"] = run("rest_sum", backend, a)["rest_sum"]
    assert run("solid_volume_rest", backend, a)["volume"] == pytest.approx([1, V0, 3], rel=1e-12)
    a["site_particle"][0] = -1  # melted
    assert np.array_equal(run("solid_volume_rest", backend, a)["volume"], [1, 2, 3])


@everywhere
@both
def test_akinci_volume_on_face_edge_and_corner(backend, precision):
    n = 7
    a, cells = body(n, precision)
    V = run("solid_volume_akinci", backend, a, solid_volume=P.VOLUME_AKINCI)["volume"] / V0
    at = {tuple(c): v for c, v in zip(cells, V)}
    middle = n // 2
    assert at[middle, middle, middle] == pytest.approx(1 / 0.9985, abs=1e-4)
    assert at[0, middle, middle] == pytest.approx(1.28, abs=5e-3)
    assert at[0, 0, middle] == pytest.approx(1.65, abs=5e-3)
    assert at[0, 0, 0] == pytest.approx(2.13, abs=5e-3)


@everywhere
@both
def test_shell_volume_counts_surface_particles_only(backend, precision):
    a, cells = body(7, precision)
    V = run("solid_volume_akinci", backend, a, solid_volume=P.VOLUME_SHELL, solid_scale=0.5)["volume"] / V0
    inside = a["site_link_count"] == 27
    assert inside.sum() == 125 and (V[inside] == 0).all()
    face = np.flatnonzero((cells == [0, 3, 3]).all(axis=1))[0]
    assert V[face] == pytest.approx(0.5 * 1.79, abs=5e-3)


@everywhere
def test_akinci_volume_ignores_other_pieces_and_liquid(backend):
    x = [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0]]
    a = solid_sites(particles(x, [1, 1, 0], volume=[1.0, 1.0, 7.0]), [[0, 0, 0], [1, 0, 0]], [0, 1])
    V = run("solid_volume_akinci", backend, a, solid_volume=P.VOLUME_AKINCI)["volume"]
    assert V == pytest.approx([1 / 20.3718327] * 2 + [7], rel=1e-8)


@everywhere
@both
def test_coincident_solids_have_finite_volumes(backend, precision):
    a = solid_sites(particles([[0, 0, 0], [0, 0, 0]], 1, precision), [[0, 0, 0], [1, 0, 0]])
    a["rest_sum"] = run("rest_sum", backend, a)["rest_sum"]
    V = run("solid_volume_rest", backend, a)["volume"]
    assert V == pytest.approx(V0 * (20.3718327 + 8.63765707) / (2 * 20.3718327), rel=1e-6)


@everywhere
def test_empty(backend):
    a = solid_sites(particles(np.zeros((0, 3))), np.zeros((0, 3), int))
    for stage in ("liquid_volume", "rest_sum", "solid_volume_rest", "solid_volume_akinci"):
        assert all(v.size == 0 for v in run(stage, backend, a).values())


@everywhere
@pytest.mark.parametrize("connect, left", [(6, 27), (18, 26), (26, 24)])
def test_shell_follows_the_bonds_of_the_scene(backend, connect, left):
    """A cube of 5^3 has 27 sites with all bonds. Without its edge site (0, 0, 2) they are fewer:

    that one is no neighbour of an inner site by a face, one of (1, 1, 2) by an edge, one of
    (1, 1, 1) and (1, 1, 3) by a corner.
    """
    a, cells = body(5, "double")
    taken = np.ones(125, bool)
    for inside in (27, left):
        table = links(cells.T, np.zeros(125, int), taken, connect)
        a["site_link_count"] = (table >= 0).sum(axis=1).astype(np.int32)
        V = run("solid_volume_akinci", backend, a, solid_volume=P.VOLUME_SHELL, connect=connect)["volume"]
        assert (V[taken] == 0).sum() == inside
        taken[(cells == (0, 0, 2)).all(axis=1)] = False
