"""The screen-space renderer as a whole: beside the reference renderer, on every backend, over terrain, in runs."""

from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image
from run_samples import drop_and_cube
from test_gas import SCENE, tank

from melt import _compile
from melt.errors import MeltError
from melt.output.camera import Camera, fit, look
from melt.output.picture import Painter, render, render_video
from melt.output.run_file import RunWriter
from melt.output.run_reader import open_run
from melt.output.screen import SMOOTH, ScreenRenderer, sky

SIZE = (320, 180)
CAMERA = fit([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5], "iso", 161, 91)


def blob(n=800, seed=0):
    x = np.random.default_rng(seed).uniform(-0.4, 0.4, (3, n))
    return x, np.full(n, 0.05)


def psnr(one, two):
    error = ((one.astype(float) - two) ** 2).mean()
    return 10 * np.log10(255**2 / error) if error else np.inf


@pytest.fixture(autouse=True)
def where_kernels_run(monkeypatch):
    """A renderer on the emulated backend leaves kernels emulated: put back what was set."""
    monkeypatch.setattr(_compile.Kernel, "emulated", _compile.Kernel.emulated)


@pytest.mark.parametrize("smooth", SMOOTH)
def test_backends_draw_the_same_picture(smooth):
    x, r = blob()
    stops = ((0.1, 0.2, 0.9), (0.9, 0.2, 0.1))
    value = np.random.default_rng(1).random(800)
    drawn = {b: ScreenRenderer(CAMERA, b, smooth, stops=stops).draw(x, r, value) for b in ("cpu", "cuda-emulated")}
    assert psnr(drawn["cpu"], drawn["cuda-emulated"]) >= 50
    if smooth == "separable":
        assert psnr(ScreenRenderer(CAMERA, "reference", smooth, stops=stops, precision="double").draw(x, r, value), drawn["cpu"]) >= 50


def test_no_particles_leave_the_background_exactly():
    renderer = ScreenRenderer(CAMERA)
    expected = np.clip(sky(CAMERA)[0], 0, 1) * np.float32(255) + np.float32(0.5)
    for x, r in (blob(0), (np.full((3, 5), np.nan), np.ones(5)), blob(0)):
        assert np.array_equal(renderer.draw(x, r), expected.astype(np.uint8))
    assert renderer.skipped == 0


def test_number_of_particles_may_change_and_broken_ones_are_counted():
    renderer = ScreenRenderer(CAMERA)
    x, r = blob()
    whole = renderer.draw(x, r)
    more = np.concatenate([x, [[np.nan], [0], [np.inf]]], axis=1)
    assert np.array_equal(renderer.draw(more, np.append(r, 0.05)), whole) and renderer.skipped == 1
    shuffle = np.random.default_rng(2).permutation(800)
    assert np.array_equal(renderer.draw(x[:, shuffle], r[shuffle]), whole)


def basin(n=41):
    axis = np.linspace(-2, 2, n)
    X, Y = np.meshgrid(axis, axis)
    return SimpleNamespace(elevation=0.2 * (X**2 + Y**2), lower=(-2.0, -2.0), cell=(4 / (n - 1), 4 / (n - 1)))


def test_shallow_water_on_terrain_ends_at_the_shore():
    """A pond of radius 1 in a paraboloid, seen from above: wet inside, the terrain outside, dry terrain computed once."""
    terrain, s = basin(), 0.05
    camera = Camera(np.array([0, 0, 9.0]), look((0, -0.02, 1.0)), 300.0, 160, 120)
    x, y = (g.ravel() for g in np.meshgrid(np.arange(-1.2, 1.2, s), np.arange(-1.2, 1.2, s)))
    wet = np.hypot(x, y) < 1.0
    renderer = ScreenRenderer(camera, below=True)
    dry = renderer.draw(np.zeros((3, 0)), np.zeros(0), terrain=terrain)
    renderer.seconds = {}
    water = renderer.draw(np.stack([x, y, np.full(x.size, 0.2)])[:, wet], np.full(wet.sum(), 1.5 * s), terrain=terrain)
    assert "relief_depth" not in renderer.seconds
    depth = renderer.arrays["screen_depth"]
    point = camera.eye + camera.rays() * np.where(np.isfinite(depth), depth, 9.0)[..., None]
    away = np.hypot(point[..., 0], point[..., 1])
    assert np.isfinite(depth[away < 0.93]).all() and np.isinf(depth[away > 1.07]).all()
    changed = (water != dry).any(axis=2)
    assert changed[away < 0.8].mean() > 0.99 and not changed[away > 1.07].any()
    length = np.repeat(np.repeat(renderer.arrays["screen_length"], 2, 0), 2, 1)[:120, :160]
    assert length[away < 0.1].mean() == pytest.approx(0.2, rel=0.1) and length[(away > 0.85) & (away < 0.93)].mean() < 0.06


def test_terrain_with_holes_and_without_ground():
    terrain = basin()
    terrain.elevation[:, 20:] = np.nan
    picture = ScreenRenderer(CAMERA, below=True).draw(np.zeros((3, 0)), np.zeros(0), terrain=terrain)
    terrain.elevation = np.full((5, 5), np.nan)
    empty = ScreenRenderer(CAMERA, below=True).draw(np.zeros((3, 0)), np.zeros(0), terrain=terrain)
    assert (picture != empty).any() and np.array_equal(empty, ScreenRenderer(CAMERA).draw(*blob(0)))


def test_beside_the_reference_renderer(tmp_path):
    """Beside the picture of particles: silhouettes overlap by 96.9 % (measured), colours differ by 17 of 255, means by 0.5."""
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf"))
    spheres, mesh, screen = (Painter(run, size=SIZE, **o).draw(0).astype(int) for o in ({}, {"surface": True}, {"screen": "narrow"}))
    left = slice(0, int(0.85 * SIZE[0]))  # of the colour bar
    hot = [(p[:, left, 0] - p[:, left, 2]) > 40 for p in (spheres, mesh, screen)]
    for reference in hot[:2]:
        assert reference.sum() > 800 and (reference & hot[2]).sum() / (reference | hot[2]).sum() > 0.93
    both = hot[0] & hot[2]
    assert np.abs(spheres[:, left][both].mean(axis=0) - screen[:, left][both].mean(axis=0)).max() < 25
    assert np.abs(spheres.mean(axis=(0, 1)) - screen.mean(axis=(0, 1))).max() < 2


def test_solid_in_front_hides_liquid_and_behind_shines_through(tmp_path):
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf"))
    for view in ("side", "front", "top"):
        render(run, tmp_path / "b.png", frame=0, view=view, size=SIZE, screen="narrow")
        assert Image.open(tmp_path / "b.png").size == SIZE
    picture = np.asarray(Image.open(tmp_path / "b.png")).astype(int)
    assert ((picture[..., 2] - picture[..., 0]) > 60).sum() > 300  # the cold cube


def test_run_without_values_has_water_and_gas_is_drawn(tmp_path):
    path = drop_and_cube(tmp_path / "a.vtkhdf", fields=())
    assert Painter(open_run(path), size=SIZE, screen="separable").draw(0).shape == (180, 320, 3)
    frame = tank(bubbles=[(0.12, 0.12, 0.10, 0.03)], vapour=[(0.12, 0.12, 0.34)])
    with RunWriter(tmp_path / "b.vtkhdf", SCENE, {}) as writer:
        writer.append(0.0, frame)
        writer.append(0.1, {k: v[:0] for k, v in frame.items()})
    painter = Painter(open_run(tmp_path / "b.vtkhdf"), size=SIZE, screen="narrow")
    assert painter.draw(0).std() > painter.draw(1).std()


def test_video(tmp_path):
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf", frames=3))
    seen = []
    render_video(run, tmp_path / "a.mp4", fps=3, size=(160, 90), screen="narrow", progress=lambda *done: seen.append(done))
    assert seen[-1] == (3, 3) and (tmp_path / "a.mp4").stat().st_size > 500


def test_unknown_smoothing_and_options_that_exclude_each_other(tmp_path):
    from typer.testing import CliRunner

    from melt.cli import app

    with pytest.raises(MeltError, match="narrow, separable, bilateral"):
        ScreenRenderer(CAMERA, smooth="gauss")
    path = str(drop_and_cube(tmp_path / "a.vtkhdf"))
    for options in (["--renderer", "rays"], ["--renderer", "screen", "--smooth", "much"], ["--renderer", "screen", "--surface"]):
        done = CliRunner().invoke(app, ["render", path, *options])
        assert done.exit_code != 0 and not (tmp_path / "a.png").exists()
    done = CliRunner().invoke(app, ["render", path, "--renderer", "screen", "--size", "160x90", "-q"])
    assert done.exit_code == 0 and (tmp_path / "a.png").exists()
