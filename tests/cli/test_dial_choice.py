"""--preset, --max-error and --budget choose a stored point, say where it sits, and write nothing when none qualifies."""

import pytest
from small_runs import melt, refused

from melt.dial import sweep
from melt.scene import shipped_scenes
from melt.scene.fronts import Front, FrontPoint, fingerprint, front_path, store


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
    store(Front({"error": "distance", "machine": "a machine", "scene hash": fingerprint(path)}, points), path)
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
    assert "changed since" not in said
    tank.write_text(tank.read_text().replace('end = "1 s"', 'end = "2 s"'))
    assert "changed since" in melt("plan", tank, *options).output


@pytest.mark.parametrize(
    "options, words",
    [(["--max-error", "1%"], "the nearest is 'dear' with 1 %"), (["--budget", "1 us"], "the nearest, 'cheap', takes about"),
     (["--max-error", "2%", "--preset", "draft"], "give one of them"), (["--max-error", "many"], "such as 2%")],
)  # fmt: skip
def test_run_without_a_point_that_qualifies_names_the_nearest_and_writes_nothing(tank, options, words):
    refused(melt("run", tank, *options), words)
    assert not list(tank.parent.glob("*.vtkhdf*"))


def test_damaged_front_is_refused_in_words(tank):
    front_path(tank).write_text("# error: x\npoint,error_percent\n")
    refused(melt("plan", tank, "--preset", "draft"), "is damaged", "measure it again")
