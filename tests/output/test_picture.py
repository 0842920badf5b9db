"""Pictures show what is there; videos are whole or absent."""

import os

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image
from run_samples import drop_and_cube

from melt.output import colours, picture
from melt.output.annotate import ticks
from melt.output.camera import VIEWS, fit
from melt.output.errors import OutputError, RunFileError
from melt.output.info import describe
from melt.output.picture import Painter, render, render_frame, render_video
from melt.output.run_file import RunWriter
from melt.output.run_reader import open_run

SIZE = (320, 180)


def coloured(image):
    """Return masks (hot, cold) of clearly red or yellow, and clearly blue, pixels left of the colour bar."""
    a = np.asarray(image).astype(int)[:, : int(0.85 * image.size[0])]
    return a[..., 0] - a[..., 2] > 60, a[..., 2] - a[..., 0] > 60


@pytest.mark.parametrize("surface", [False, True])
@pytest.mark.parametrize("view", ["iso", "side", "top"])
def test_hot_drop_left_cold_cube_right(tmp_path, view, surface):
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf"))
    render_frame(run, 0, tmp_path / "a.png", view=view, surface=surface, size=SIZE)
    image = Image.open(tmp_path / "a.png")
    assert image.size == SIZE and image.mode == "RGB"
    hot, cold = coloured(image)
    assert hot.sum() > 800 and cold.sum() > 300
    assert np.nonzero(hot)[1].mean() < np.nonzero(cold)[1].mean() - 40
    assert os.listdir(tmp_path).count("a.png") == 1 and len(os.listdir(tmp_path)) == 2


def test_solid_is_seen_through_liquid(tmp_path):
    """A cold cube inside a hot drop shows: liquid is translucent, solid is not."""
    axis = np.arange(-9, 9) + 0.5
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    grid = grid[(grid**2).sum(axis=1) < 64]
    cube = np.abs(grid).max(axis=1) < 4
    for name, phase in (("ice", np.where(cube, 1, 0)), ("water", np.zeros(len(grid)))):
        with RunWriter(tmp_path / f"{name}.vtkhdf", "", {}) as writer:
            T = np.where(cube, -10.0, 80.0)
            writer.append(0, {"position": grid * 0.02, "phase": phase.astype(np.int32), "temperature": T})
        render(tmp_path / f"{name}.vtkhdf", tmp_path / f"{name}.png", size=SIZE, view="side")
    ice, water = (np.asarray(Image.open(tmp_path / f"{n}.png")).astype(int) for n in ("ice", "water"))
    middle = (slice(80, 100), slice(130, 150))
    assert ice[middle][..., 0].mean() < water[middle][..., 0].mean() - 8


def test_pictures_do_not_depend_on_threads(tmp_path):
    numba = pytest.importorskip("numba")
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf"))
    before = numba.get_num_threads()
    one = Painter(run, size=SIZE).draw(1)
    numba.set_num_threads(1)
    assert np.array_equal(one, Painter(run, size=SIZE).draw(1))
    numba.set_num_threads(before)


@pytest.mark.parametrize(
    "fields, phase, expected",
    [
        (("temperature", "velocity"), True, "temperature"),
        (("velocity",), True, "speed"),
        ((), True, "phase"),
        ((), False, "position"),
    ],
)
def test_field_falls_back(tmp_path, fields, phase, expected):
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf", fields=fields, phase=phase))
    painter = Painter(run, size=SIZE)
    assert painter.colouring.field == expected
    assert painter.draw(0).std() > 5
    assert Painter(run, size=SIZE, surface=True).draw(0).std() > 5


def test_colours_are_cold_blue_yellow_hot_red(tmp_path):
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf"))
    scale = colours.choose(run, "temperature")
    assert (scale.low, scale.high, scale.unit) == (-10.0, 80.0, "degC")
    assert np.allclose(
        scale.rgb([-10, 35, 80, 999, np.nan]), np.array(colours.TEMPERATURE)[[0, 1, 2, 2, 0]], atol=1e-6
    )
    middle = (np.array(colours.TEMPERATURE[0]) + colours.TEMPERATURE[1]) / 2
    assert np.allclose(scale.rgb(12.5), middle, atol=1e-6)
    assert ticks(-10, 80) == [0, 20, 40, 60, 80] and ticks(3, 3) == [3]


@pytest.mark.parametrize("view", list(VIEWS))
def test_camera_shows_the_whole_box(view):
    low, high = np.array([10.0, -3, 5]), np.array([12.0, 4, 5.5])
    camera = fit(low, high, view, 640, 360, margin=0.1, right=0.12)
    corners = np.array([[(low, high)[b][k] for k, b in enumerate(bits)] for bits in np.ndindex(2, 2, 2)])
    pixel = camera.pixels(corners)
    assert (camera.view(corners)[:, 2] > 0).all()
    assert pixel.min() > 0 and (pixel.max(axis=0) < (640 * 0.9, 360)).all()
    assert np.ptp(pixel[:, 0]) > 0.6 * 640 * 0.88 or np.ptp(pixel[:, 1]) > 0.6 * 360  # and fills the picture


def test_empty_frames_and_no_frames(tmp_path):
    with RunWriter(tmp_path / "a.vtkhdf", "", {}) as writer:
        with pytest.raises(OutputError, match="no frame"):
            render(tmp_path / "a.vtkhdf", tmp_path / "a.png")
        none = {"position": np.zeros((0, 3)), "phase": np.zeros(0, np.int32), "temperature": np.zeros(0)}
        writer.append(0, none)
        one = {"position": np.ones((1, 3)), "phase": np.zeros(1, np.int32), "temperature": np.full(1, np.nan)}
        writer.append(1, one)
    for surface in (False, True):
        for k in (0, 1):
            render(tmp_path / "a.vtkhdf", tmp_path / "a.png", frame=k, surface=surface, size=SIZE)
    with pytest.raises(RunFileError, match="2 frames"):
        render(tmp_path / "a.vtkhdf", tmp_path / "a.png", frame=2)
    with pytest.raises(OutputError, match="unknown view"):
        render(tmp_path / "a.vtkhdf", tmp_path / "a.png", view="above")


def test_video_has_every_frame(tmp_path):
    path = drop_and_cube(tmp_path / "a.vtkhdf", frames=4)
    seen = []
    render(
        path,
        tmp_path / "a.mp4",
        fps=4,
        size=(161, 91),
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen == [(1, 4), (2, 4), (3, 4), (4, 4)]
    reader = imageio_ffmpeg.read_frames(str(tmp_path / "a.mp4"))
    facts = next(reader)
    assert tuple(facts["size"]) == (160, 90) and facts["fps"] == 4 and len(list(reader)) == 4


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_interrupted_video_leaves_nothing(tmp_path, error):
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf", frames=4))
    (tmp_path / "a.mp4").write_bytes(b"older")

    def stop(done, total):
        if done == 2:
            raise error

    with pytest.raises(error):
        render_video(run, tmp_path / "a.mp4", size=SIZE, progress=stop)
    assert (
        sorted(os.listdir(tmp_path)) == ["a.mp4", "a.vtkhdf"]
        and (tmp_path / "a.mp4").read_bytes() == b"older"
    )


def test_picture_that_cannot_be_saved(tmp_path, monkeypatch):
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf"))

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(picture.Image.Image, "save", full)
    with pytest.raises(OutputError, match="disk is full"):
        render_frame(run, 0, tmp_path / "a.png", size=SIZE)
    assert os.listdir(tmp_path) == ["a.vtkhdf"]


def test_info(tmp_path):
    path = drop_and_cube(tmp_path / "a.vtkhdf")
    rows = dict(describe(path))
    assert rows["scene"] == "drop" and rows["frames"] == "2, t = 0 .. 0.1 s" and rows["checkpoint"] == "none"
    assert rows["first frame"] == "912 liquid, 216 solid" and rows["particles"] == "1,128"
    assert "temperature [degC]" in rows["fields"] and rows["last kinetic energy"] == "1.5 J"
    assert rows["last solid particles"] == "211"  # a number without unit keeps its last digits
    assert rows["last ms of all stages"] == "2 ms" and rows["melt"] == "0"
    with RunWriter(tmp_path / "b.vtkhdf", "[scene", {}):
        assert dict(describe(tmp_path / "b.vtkhdf"))["frames"] == "none yet"


@pytest.mark.parametrize("view", list(VIEWS))
def test_domain_box_that_is_drawn_fits_whole_into_the_picture(tmp_path, view):
    scene = "[domain]\nlower = [0, 0, 0]\nupper = [2.8, 2.4, 3.2]\nspacing = 0.2\n"
    low = [[0.1, 0.1, 0.1], [2.7, 2.3, 1.9], [1.4, 1.2, 0.5]]
    frame = {"id": np.arange(3, dtype=np.int32), "position": np.array(low, np.float32)}
    with RunWriter(tmp_path / "box.vtkhdf", scene, {}) as writer:
        writer.append(0.0, frame)
    painter = Painter(open_run(tmp_path / "box.vtkhdf"), size=(640, 360), view=view)
    assert painter.boxed
    corners = np.array([[painter.box[b][k] for k, b in enumerate(bits)] for bits in np.ndindex(2, 2, 2)])
    pixels = painter.camera.pixels(corners)
    assert (pixels >= 0).all() and (pixels <= [640, 360]).all()


def test_a_field_that_the_run_has_not_is_refused(tmp_path):
    run = open_run(drop_and_cube(tmp_path / "run.vtkhdf"))
    with pytest.raises(OutputError, match="did you mean temperature"):
        colours.choose(run, "temprature")
