"""Smoothing of depth: still water becomes flat, edges stay, the fast forms stay close to the whole window (flood 5, R3)."""

import numpy as np
import pytest
from liquid_cases import everywhere
from screen_cases import FILTER, run, sizes, view

from melt import params as P
from melt.output.camera import Camera, look
from melt.output.screen import SMOOTH, ScreenRenderer

SHAPE, FOCAL = (40, 50), 60.0


def smoothed(name, backend, depth, precision="single", **changed):
    """Return the depth after a stage; both passes where there are two."""
    filter = P.make(P.Filter, np.float32 if precision == "single" else np.float64, **{**FILTER, **changed})
    a = dict(screen_depth=np.array(depth, float))
    camera = view(a["screen_depth"].shape, FOCAL, precision)
    for along in (0, 1):
        params = dict(filter=filter, view=camera) | ({} if name == "bilateral" else {"along": np.int32(along)})
        if name != "bilateral" or along == 0:
            run(name, backend, a, sizes(a["screen_depth"].shape), precision, **params)
            a["screen_depth"] = a["screen_depth_next"]
    return a["screen_depth"]


every_filter = pytest.mark.parametrize("name", ["bilateral", "bilateral_pass", "narrow_pass"])


@everywhere
@every_filter
def test_plane_towards_the_eye_stays(backend, name):
    depth = np.full(SHAPE, 4.0)
    depth[10:20, 5:9] = np.inf
    assert np.array_equal(smoothed(name, backend, depth), depth.astype(np.float32))


@everywhere
@every_filter
def test_noise_goes_and_the_mean_stays(backend, name):
    noise = np.random.default_rng(0).uniform(-0.05, 0.05, SHAPE)
    left = smoothed(name, backend, 4 + noise, size=0.2) - 4
    inner = left[8:-8, 8:-8]
    assert inner.std() < 0.3 * noise.std() and abs(inner.mean()) < 0.004


@everywhere
@every_filter
def test_far_wall_is_not_drawn_towards_a_near_one(backend, name):
    """A step of many sigma_r keeps its place; what is near may be drawn back by mu at most (narrow range)."""
    depth = np.full(SHAPE, 3.0)
    depth[:, 25:] = 6.0
    out = smoothed(name, backend, depth)
    assert out[:, 25:] == pytest.approx(6.0, abs=1e-4)
    assert out[:, :25].max() <= 3.0 + (FILTER["clamp"] if name == "narrow_pass" else 1e-4)


@everywhere
@every_filter
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (3, 70)])
def test_small_and_empty_pictures(backend, name, shape):
    assert np.isinf(smoothed(name, backend, np.full(shape, np.inf))).all()
    assert smoothed(name, backend, np.full(shape, 2.0)) == pytest.approx(2.0)


def test_narrow_range_follows_a_slope_that_the_bilateral_filter_takes_for_an_edge():
    column = np.arange(50) * 0.3 + 4
    noise = np.random.default_rng(1).uniform(-0.1, 0.1, SHAPE)
    narrow, plain = (smoothed(name, "cpu", column + noise, size=0.5, narrow=0.5) - column for name in ("narrow_pass", "bilateral_pass"))
    assert narrow[10:-10, 12:30].std() < 0.5 * plain[10:-10, 12:30].std()


def test_two_passes_stay_close_to_the_whole_window():
    """The difference of the separable form, in radii (sigma_r = 2 r): the figure that the documentation gives."""
    row, column = np.mgrid[:40, :50]
    radius = FILTER["range"] / 2
    depth = 4 + 0.3 * np.sin(row / 9) * np.cos(column / 11) + radius * 0.4 * np.random.default_rng(2).random(SHAPE)
    whole, passes = (smoothed(name, "cpu", depth, size=0.2) for name in ("bilateral", "bilateral_pass"))
    assert np.abs(whole - passes)[8:-8, 8:-8].max() < 0.1 * radius


@everywhere
def test_blur_keeps_the_sum_and_spreads_a_spot(backend):
    a = dict(screen_length=np.zeros((31, 41)))
    a["screen_length"][15, 20] = 1.0
    extents = dict(half_row=31, half_column=41)
    for along in (0, 1):
        run("screen_blur", backend, a, extents, deviation=np.float32(2.0), along=np.int32(along))
        a["screen_length"] = a["screen_length_next"]
    out = a["screen_length"].astype(float)
    assert out.sum() == pytest.approx(1, rel=1e-5) and out[15, 20] == out.max()
    rows = ((np.arange(31) - 15) ** 2 * out.sum(axis=1)).sum()
    assert rows == pytest.approx(4.0, rel=0.12)  # cut off at 2.5 deviations


@pytest.mark.parametrize("smooth", SMOOTH)
def test_still_lake_is_flat(smooth):
    """Mean tilt of at most 1 degree and depth within 0.1 r, for a jittered sheet of shallow water."""
    rng, s = np.random.default_rng(4), 0.1
    x, y = (g.ravel() + rng.uniform(-0.2, 0.2, g.size) * s for g in np.meshgrid(np.arange(-30, 30) * s, np.arange(-30, 30) * s))
    direction = np.array([0.0, -0.8, 1.0])
    camera = Camera(6 * direction / np.linalg.norm(direction), look(direction), 330.0, 240, 180)
    renderer = ScreenRenderer(camera, smooth=smooth, below=True)
    radius = np.full(x.size, 1.5 * s)
    renderer.surface(np.stack([x, y, np.zeros_like(x)]), radius)
    depth, normal = renderer.arrays["screen_depth"], renderer.arrays["screen_normal"]
    inner = np.zeros(depth.shape, bool)
    inner[50:130, 60:180] = True
    assert np.isfinite(depth[inner]).all()
    n = np.moveaxis(normal, 0, 2)[inner] @ camera.axes
    assert np.degrees(np.arccos(np.clip(n[:, 2], -1, 1))).mean() <= 1.0
    height = (camera.eye + camera.rays() * depth[..., None])[..., 2][inner]
    assert height.std() <= 0.1 * radius[0] and -0.25 * radius[0] < height.mean() < 0.01 * radius[0]
