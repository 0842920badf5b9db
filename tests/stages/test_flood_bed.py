"""Bed, slope and curvature between the nodes of the terrain (flood E5)."""

import numpy as np
import pytest
from flood_cases import AIRBORNE, INACTIVE, LIQUID, TERRAIN, arrays, run
from liquid_cases import REALS, both, everywhere

from melt import params as P

SAMPLERS = (P.SAMPLER_BSPLINE, P.SAMPLER_BILINEAR, P.SAMPLER_BICUBIC)
WIDE = dict(origin_x=-1.0, origin_y=2.0, inverse_dx=2.0, inverse_dy=0.5)  # dx = 0.5 m, dy = 2 m
sampled = pytest.mark.parametrize("sampler", SAMPLERS, ids=("bspline2", "bilinear", "bicubic"))


def nodes(**changes):
    """Coordinates of all nodes, shape (ny nx,) each."""
    t = {**TERRAIN, **changes}
    j, i = np.meshgrid(np.arange(t["ny"]), np.arange(t["nx"]), indexing="ij")
    return (t["origin_x"] + i / t["inverse_dx"]).ravel(), (t["origin_y"] + j / t["inverse_dy"]).ravel()


def bed_at(x, z, backend="reference", precision="double", sampler=P.SAMPLER_BSPLINE, phase=LIQUID, **changes):
    """Bed, slopes, curvatures at x (n, 2) of nodes z."""
    a = arrays(x, 1.0, 1.0, phase, precision, terrain=z)
    run("bed", backend, a, sampler=sampler, **changes)
    run("bed_curvature", backend, a, sampler=sampler, **changes)
    return a["bed"], a["bed_slope"], a["bed_curvature"]


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_weights_of_the_spline_by_hand(backend, precision):
    """A node alone at 1 m: 3/4 3/4 above it, 1/2 3/4 half a cell aside, 1/8 3/4 over the next node; slopes -2u, ..."""
    z = np.zeros(48)
    z[8 * 2 + 3] = 1.0
    b, s, c = bed_at([[3, 2], [3.5, 2], [4, 2], [3.25, 2]], z, backend, precision)
    assert b == pytest.approx([0.5625, 0.375, 0.09375, 0.75 * (0.75 - 0.0625)], rel=1e-6)
    assert s[0] == pytest.approx([0, -0.75, -0.375, -0.375], rel=1e-6)
    assert s[1] == pytest.approx(np.zeros(4), abs=1e-7)
    assert c[0][[0, 2, 3]] == pytest.approx([-1.5, 0.75, -1.5], rel=1e-6)
    assert min(abs(c[0][1] + 1.5), abs(c[0][1] - 0.75)) < 1e-6  # jumps at u = 1/2: either side's


@everywhere
@both
@sampled
def test_plane_is_a_plane(backend, precision, sampler):
    """With dx != dy: value, slope (0.25, -0.125) and no curvature; inside the outermost nodes but one."""
    x, y = nodes(**WIDE)
    at = np.random.default_rng(1).uniform((-0.5, 4.0), (2.0, 10.0), (40, 2))
    b, s, c = bed_at(at, 3 + 0.25 * x - 0.125 * y, backend, precision, sampler, **WIDE)
    tolerance = 3e-6 if precision == "single" else 1e-13
    assert b == pytest.approx(3 + 0.25 * at[:, 0] - 0.125 * at[:, 1], abs=tolerance)
    assert s == pytest.approx(np.array([[0.25], [-0.125]]) + np.zeros(40), abs=tolerance)
    assert np.abs(c).max() < 10 * tolerance


@everywhere
@sampled
def test_slope_and_curvature_are_exact_derivatives(backend, sampler):
    """Central differences of what the stage samples, on rough ground; curvature of the slopes likewise."""
    rng = np.random.default_rng(3)
    z = rng.uniform(0, 2, 48)
    at = rng.uniform((-1.5, 1), (3.0, 13.0), (60, 2))
    t = np.array([(at[:, 0] + 1) * 2, (at[:, 1] - 2) * 0.5])
    at = at[(np.abs(t % 0.5 - 0.25) < 0.24).all(axis=0)]  # away from where polynomials meet
    e = 1e-5
    _, s, c = bed_at(at, z, backend, "double", sampler, **WIDE)
    for axis, step in enumerate(([e, 0], [0, e])):
        (b1, s1, _), (b0, s0, _) = (bed_at(at + np.multiply(sign, step), z, backend, "double", sampler, **WIDE) for sign in (1, -1))
        assert s[axis] == pytest.approx((b1 - b0) / (2 * e), abs=1e-8)
        assert c[axis] == pytest.approx((s1 - s0)[axis] / (2 * e), abs=1e-7)
        assert c[2] == pytest.approx((s1 - s0)[1 - axis] / (2 * e), abs=1e-7)


@everywhere
def test_spline_smooths_curvature_by_an_eighth(backend):
    """b = x^2: the spline gives x^2 + dx^2/4 and b'' = 2; Catmull-Rom goes through the nodes."""
    x, _ = nodes()
    at = np.random.default_rng(4).uniform((2, 2), (5, 3), (20, 2))
    b, s, c = bed_at(at, x**2, backend)
    assert b == pytest.approx(at[:, 0] ** 2 + 0.25, rel=1e-13)
    assert s[0] == pytest.approx(2 * at[:, 0], rel=1e-13) and c[0] == pytest.approx(np.full(20, 2.0), rel=1e-12)
    b, s, _ = bed_at(at, x**2, backend, sampler=P.SAMPLER_BICUBIC)
    assert b == pytest.approx(at[:, 0] ** 2, rel=1e-13)


@everywhere
def test_only_catmull_rom_overshoots_at_a_cliff(backend):
    x, _ = nodes()
    at = np.column_stack([np.linspace(0, 7, 300), np.full(300, 2.3)])
    z = np.where(x > 3.5, 10.0, 0.0)
    for sampler in SAMPLERS:
        b = bed_at(at, z, backend, sampler=sampler)[0]
        over = b.min() < -0.1 and b.max() > 10.1
        assert over == (sampler == P.SAMPLER_BICUBIC), (b.min(), b.max())


@everywhere
@sampled
@pytest.mark.parametrize("precision", REALS)
def test_spline_is_smooth_where_polynomials_meet_and_beyond_the_edges(backend, precision, sampler):
    """Value everywhere, slope of the C1 samplers: no jump at nodes, halves, edges and where the constant begins."""
    z = np.random.default_rng(5).uniform(0, 2, 48)
    t = np.concatenate([np.arange(-4, 11), np.arange(-4, 11) + 0.5])
    e = 1e-3 if precision == "single" else 1e-6
    sides = [bed_at(np.column_stack([t + d, np.full(len(t), 2.3)]), z, backend, precision, sampler) for d in (-e, e)]
    assert np.abs(sides[1][0] - sides[0][0]).max() < 10 * e
    if sampler != P.SAMPLER_BILINEAR:
        assert np.abs(sides[1][1] - sides[0][1]).max() < 30 * e


@everywhere
@sampled
@pytest.mark.parametrize("precision", REALS)
def test_places_off_the_terrain_read_its_edge(backend, precision, sampler):
    """Constant beyond the edge, at 2^30 m and infinity too; NaN counts as node 0; nothing is read outside."""
    z = np.arange(48.0)
    x = [-1e3, 2.0**30, -np.inf, np.inf, np.nan]
    b, s, c = bed_at(np.column_stack([x, np.full(5, 2.0)]), z, backend, precision, sampler)
    assert b == pytest.approx([16, 23, 16, 23, 16], abs=1e-5)
    assert (s[0] == 0).all() and (c[0] == 0).all() and s[1] == pytest.approx(np.full(5, 8.0))
    b = bed_at(np.full((1, 2), np.nan), z, backend, precision, sampler)[0]
    assert b.tolist() == [0]


@everywhere
def test_falling_columns_have_a_bed_and_waiting_ones_none(backend):
    b, s, c = bed_at([[3.2, 2.1]] * 3, np.arange(48.0) ** 2, backend, phase=[LIQUID, AIRBORNE, INACTIVE])
    assert b[0] == b[1] > 0 and b[2] == 0
    assert (s[:, 0] == s[:, 1]).all() and (s[:, 2] == 0).all() and (c[:, 0] == c[:, 1]).all() and (c[:, 2] == 0).all()
    assert bed_at(np.zeros((0, 2)), np.zeros(48), backend)[0].shape == (0,)


@everywhere
@pytest.mark.parametrize("precision", ("mixed", "double"))
def test_place_far_from_the_origin_keeps_its_digits(backend, precision):
    """Terrain at 6.35e6 m: in `mixed` the difference is taken in float64, so only the bed is rounded."""
    z = np.random.default_rng(6).uniform(0, 2, 48)
    near = bed_at([[3.2, 2.1]], z, backend, precision)
    far = bed_at([[3.2 + 6.35e6, 2.1]], z, backend, precision, origin_x=6.35e6)
    for a, b in zip(near, far):
        assert a == pytest.approx(b, rel=1e-6)
