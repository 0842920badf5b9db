"""Normals, light, and the ground behind (flood 5, R4, R6, R0)."""

import numpy as np
import pytest
from liquid_cases import everywhere
from screen_cases import DOWN, rays, run, sizes, splatted, view

from melt import params as P
from melt.check._screen import OPTICS

SHAPE, FOCAL = (40, 50), 60.0


@everywhere
def test_normals_of_a_sphere(backend):
    """Within 1 degree of the analytic ones inside 0.8 r."""
    shape, focal, centre, r = (240, 240), 900.0, np.array([0.05, -0.03, 6.0]), 0.7
    a = splatted("cpu", [centre[0], centre[2], -centre[1]], r, shape, view(shape, focal, "double"), "double")
    run("screen_normal", backend, a, sizes(shape), "double", view=view(shape, focal, "double"))
    u, v = rays(shape, focal)
    point = np.stack([u, v, np.ones_like(u)]) * np.where(np.isfinite(a["screen_depth"]), a["screen_depth"], 1)
    exact = (point - centre[:, None, None]) / r
    inside = np.isfinite(a["screen_depth"]) & (np.hypot(exact[0], exact[1]) < 0.8)
    cosine = (exact * a["screen_normal"]).sum(axis=0)[inside]
    assert inside.sum() > 15000 and np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() <= 1.0


@everywhere
def test_normals_of_a_tilted_plane_an_edge_and_a_lone_pixel(backend):
    slope = np.array([0.3, -0.2])  # z = 4 + 0.3 x - 0.2 y
    u, v = rays(SHAPE, FOCAL)
    depth = 4 / (1 - slope[0] * u - slope[1] * v)
    depth[:, 30:], depth[:5] = np.inf, np.inf
    depth[20, 40] = 3.0
    a = dict(screen_depth=depth)
    run("screen_normal", backend, a, sizes(SHAPE), "double", view=view(SHAPE, FOCAL, "double"))
    n = np.array([*slope, -1]) / np.sqrt(1 + slope @ slope)
    some = np.isfinite(depth) & (depth != 3.0)
    assert np.abs(a["screen_normal"][:, some] - n[:, None]).max() < 1e-12
    assert np.array_equal(a["screen_normal"][:, 2, 2], [0, 0, -1])
    lone = np.array([u[20, 40], v[20, 40], 1.0]) @ a["screen_normal"][:, 20, 40]
    assert lone < -0.99


def shaded(backend, depth, normal, length, precision="single", **changed):
    """Return (picture, colour behind)."""
    real = np.float32 if precision == "single" else np.float64
    h, w = SHAPE
    a = dict(screen_depth=np.full(SHAPE, depth), screen_normal=np.broadcast_to(np.reshape(normal, (3, 1, 1)), (3, h, w)).astype(float))
    a |= dict(screen_length=np.full((h // 2, w // 2), length), screen_value=np.zeros((2, h // 2, w // 2)))
    a |= dict(screen_map=np.zeros((3, 2)), behind_depth=np.full(SHAPE, 9.0), behind_colour=np.random.default_rng(0).random((3, h, w)))
    a |= {k: changed.pop(k) for k in list(changed) if k in a}
    optics = P.make(P.Optics, real, **{**OPTICS, "shine": 0.0, **changed})
    run("screen_shade", backend, a, sizes(SHAPE), precision, view=view(SHAPE, FOCAL, precision), optics=optics)
    return a["picture"], a["behind_colour"]


@everywhere
@pytest.mark.parametrize("precision", ["single", "double"])
def test_without_liquid_the_picture_is_what_stands_behind(backend, precision):
    picture, behind = shaded(backend, np.inf, [0, 0, -1], 1.0, precision)
    assert np.array_equal(picture, behind.astype(picture.dtype))


@everywhere
def test_thin_clear_liquid_lets_everything_through_but_what_it_mirrors(backend):
    picture, behind = shaded(backend, 4.0, [0, 0, -1], 0.0)
    sky = (picture - behind * (1 - 0.0201))[:, 20, 25] / 0.0201  # towards the eye: F = F0
    assert (np.abs(sky) < 1.01).all()
    black, _ = shaded(backend, 4.0, [0, 0, -1], 0.0, behind_colour=np.zeros((3, *SHAPE)))
    assert black[:, 20, 25] == pytest.approx(picture[:, 20, 25] - 0.9799 * behind[:, 20, 25], abs=2e-5)


@everywhere
def test_deep_liquid_has_its_own_colour_by_beer_and_lambert(backend):
    still = dict(zenith_red=0, horizon_red=0, nadir_red=0, refraction=0, ambient=1)
    for length in (0.5, 2.0, 50.0):
        picture, behind = shaded(backend, 4.0, [0, 0, -1], length, **still)
        e = np.exp(-OPTICS["absorb_red"] * length)
        middle = (OPTICS["body_red"] * (1 - e) + behind[0, 20, 25] * e) * (1 - 0.0201)
        assert picture[0, 20, 25] == pytest.approx(middle, abs=2e-4)


@everywhere
def test_grazing_surface_mirrors_the_sky_whole(backend):
    n = np.array([0.0, -1.0, -1e-4])
    picture, _ = shaded(backend, 4.0, n / np.linalg.norm(n), 1.0, absorb_red=0, absorb_green=0, absorb_blue=0, up_x=0, up_y=-1, up_z=0)
    sky = np.array([OPTICS[f"horizon_{k}"] for k in ("red", "green", "blue")])
    assert picture[:, 20, 25] == pytest.approx(sky, abs=0.05)  # v = 1/120: F = 0.96


@everywhere
def test_refraction_looks_past_what_stands_in_front(backend):
    """A near object beside the liquid is not seen through it."""
    behind_depth, colour = np.full(SHAPE, 9.0), np.zeros((3, *SHAPE))
    behind_depth[:, 25:], colour[0, :, 25:] = 2.0, 1.0
    n = np.array([-0.6, 0, -0.8])
    picture, _ = shaded(backend, np.where(np.arange(50) < 25, 4.0, np.inf) + np.zeros(SHAPE), n, 1.0, behind_depth=behind_depth,
                        behind_colour=colour, absorb_red=0, refraction=2.0, zenith_red=0, horizon_red=0, nadir_red=0)
    assert picture[0, :, :25].max() == 0.0 and picture[0, :, 25:].min() == 1.0


def ground(backend, height, camera, shape=SHAPE, cell=(0.5, 0.4), lower=(-3.0, -2.0), base=-9.0, precision="double"):
    a, real = dict(relief_height=height), np.float64 if precision == "double" else np.float32
    relief = P.make(P.Relief, real, lower_x=lower[0], lower_y=lower[1], cell_x=cell[0], cell_y=cell[1], base=base)
    run("relief_depth", backend, a, sizes(shape), precision, relief=relief, view=camera)
    return a["behind_depth"]


@everywhere
def test_plane_from_above_and_beyond_its_edge(backend):
    camera = view(SHAPE, FOCAL, "double", eye=(0, 0, 8), axes=DOWN)
    x, y = np.meshgrid(-3 + 0.5 * np.arange(13), -2 + 0.4 * np.arange(11))
    depth = ground(backend, 0.25 * x + 0.1 * y, camera)
    u, v = rays(SHAPE, FOCAL)
    exact = 8 / (1 + 0.25 * u - 0.1 * v)  # the ray is (u, -v, -1): down the picture is towards -y
    on = (np.abs(exact * u) < 2.99) & (np.abs(exact * v) < 1.99)
    off = (np.abs(exact * u) > 3.01) | (np.abs(exact * v) > 2.01)
    assert depth[on] == pytest.approx(exact[on], rel=1e-12) and on.sum() > 500
    assert np.isinf(depth[off & ((np.abs(9 * u) > 3.01) | (np.abs(9 * v) > 2.01))]).sum() > 50


@everywhere
def test_holes_have_no_ground_and_the_block_has_cut_faces(backend):
    height = np.zeros((11, 13))
    height[5, 6] = np.nan
    down = view(SHAPE, FOCAL, "double", eye=(0, 0, 8), axes=DOWN)
    depth = ground(backend, height, down)
    assert np.isinf(depth[18:22, 23:27]).all() and depth[8, 10] == pytest.approx(8.0)
    assert np.isinf(ground(backend, np.full((11, 13), np.nan), down)).all()
    level = view(SHAPE, FOCAL, "double", eye=(0.1, -6, -1))  # looks at the face y = -2, four away, 0 >= z >= -9
    face = ground(backend, height * 0, level)
    assert face[25, 25] == pytest.approx(4.0) and np.isinf(face[2, 25])
