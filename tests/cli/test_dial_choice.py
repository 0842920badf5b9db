"""--preset, --max-error and --budget choose a stored point, say where it sits, and write nothing when none qualifies."""

import math

import pytest
from small_runs import melt, refused

from melt.dial import sweep
from melt.scene import shipped_scenes
from melt.scene.fronts import Front, FrontPoint, front_path, scene_hash, store, stored_front


def point(name, cost, error, spread, *overrides):
    return FrontPoint(name, overrides, 10 * cost, cost, 1000, error, spread)


@pytest.fixture
def tank(tmp_path, monkeypatch):
    """A scene file of one's own with a front stored beside it."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "my.toml"
    path.write_text(shipped_scenes()["tank_small"].read_text())
    cheap = point("cheap", 2.0, 6.0, 0.1, "solver.precision=single")
    points = sweep.chosen([point("default", 10.0, 4.0, 0.1), cheap, point("dear", 30.0, 1.0, 0.5, "fluid.compression=0.005")])
    store(Front({"error": "distance", "machine": "a machine", "scene hash": scene_hash(path)}, points), path)
    return path


@pytest.mark.parametrize(
    "options, point, error",
    [(["--preset", "draft"], "cheap", "6 % ± 0.1 % (default 4 %)"), (["--max-error", "2%"], "dear", "1 % ± 0.5 % (default 4 %)"),
     (["--budget", "1 h"], "dear", "3.00x of default's")],
)  # fmt: skip
def test_plan_says_which_point_was_chosen_and_where_it_sits(tank, options, point, error):
    said = melt("plan", tank, *options).output
    assert said.startswith(f"{options[0].lstrip('-') if options[0] == '--preset' else options[0]} {options[1]}: point '{point}'"), said
    assert error in said and "a machine: on another machine ratios carry over, milliseconds do not" in said
    assert "changed since" not in said and "on top" not in said
    assert "with --set and --precision on top" in melt("plan", tank, *options, "--set", "fluid.alpha=0.1", "--precision", "double").output
    tank.write_text(tank.read_text().replace('end = "1 s"', 'end = "2 s"'))
    assert "changed since" in melt("plan", tank, *options).output


@pytest.mark.parametrize(
    "options, words",
    [(["--max-error", "1%"], "the nearest is 'dear' with 1 %"), (["--budget", "1 us"], "the nearest, 'cheap', takes about"),
     (["--max-error", "2%", "--preset", "draft"], "give one of them"), (["--max-error", "many"], "such as 2%"),
     (["--max-error", "5"], "write 5%"), (["--budget", "-1 s"], "above 0 s"), (["--preset", "drat"], "did you mean draft?")],
)  # fmt: skip
def test_run_without_a_point_that_qualifies_names_the_nearest_and_writes_nothing(tank, options, words):
    refused(melt("run", tank, *options), words)
    assert not list(tank.parent.glob("*.vtkhdf*"))


def test_damaged_front_is_refused_in_words(tank):
    whole = front_path(tank).read_text()
    for text in ("# error: x\npoint,error_percent\n", whole[: whole.index("precision=single")], ""):
        front_path(tank).write_text(text)
        refused(melt("plan", tank, "--preset", "draft"), "is damaged", "measure it again")


def test_run_file_tells_the_point_that_was_chosen(tank):
    assert melt("run", tank, "--preset", "draft", "--until", "0.005 s", "-q", "-b", "cpu").exit_code == 0
    assert "preset draft: point 'cheap'" in melt("info", "my.vtkhdf").output


def test_scene_that_failed_when_its_front_was_measured_has_no_time(tank):
    front = stored_front(tank)
    failed = front.default._replace(ms_per_step=math.nan, s_per_simulated_s=math.nan, error=math.nan, failure="unstable: x")
    store(front._replace(points=[failed, *front.points[1:]]), tank)
    refused(melt("plan", tank, "--budget", "1 h"), "did not run when its front was measured")
    assert "point 'dear'" in melt("plan", tank, "--max-error", "2%").output


def test_a_scene_file_names_no_measured_preset(tank):
    tank.write_text('preset = "draft"\n' + tank.read_text())
    refused(melt("plan", tank), "give --preset draft")
