"""Values that no run can use: refused in one paragraph, before anything compiles or is written."""

import os
import shutil
import warnings

import pytest
from small_runs import SCENE, melt, refused

from melt.output.checkpoint import beside

SOLID = '[[solid]]\nlower = [0.2, 0.2, 0.8]\nupper = [0.6, 0.6, 1.2]\ntemperature = "-500 degC"\n'
HEATER = "[[heat.heater]]\nposition = [0, 0, 0]\nradius = 1\nshape = 'sphere'\ntemperature = -300\n"
BAD_VALUES = {
    "presets no table": ("presets = 5\n" + SCENE, ["presets must be tables"]),
    "presets a list": ('presets = ["a"]\n' + SCENE, ["presets must be tables"]),
    "a preset no table": (SCENE + "[presets]\ncoarse = 5\n", ["presets must be tables"]),
    "preset a list": ('preset = ["a"]\n' + SCENE, ["preset = ['a'] is not allowed", "name of one preset"]),
    "preset a table": (SCENE + "[preset]\na = 5\n", ["preset = {'a': 5} is not allowed"]),
    "solid too cold": (SCENE + SOLID, ["solid.0.temperature = -500", "at least -273.15"]),
    "liquid too cold": (SCENE + "[fluid]\ntemperature = -273.16\n", ["fluid.temperature", "at least -273.15"]),
    "wall too cold": (SCENE + "[heat]\nwall_temperature = -274\n", ["heat.wall_temperature", "at least -273.15"]),
    "air too cold": (SCENE + '[heat]\nambient_temperature = "-1 K"\n', ["heat.ambient_temperature", "at least -273.15"]),
    "heater too cold": (SCENE + HEATER, ["heat.heater.0.temperature = -300", "at least -273.15"]),
    "melting point too cold": (
        SCENE + SOLID.replace('temperature = "-500 degC"', "melting_point = -300"),
        ["solid.0.melting_point = -300", "at least -273.15"],
    ),
    "unknown field": (
        SCENE + '[output]\nfields = ["velocty"]\n',
        ["output.fields: there is no field 'velocty'", "did you mean 'velocity'", "latent_energy"],
    ),
    "field like no other": (SCENE + '[output]\nfields = ["id", "nonsense"]\n', ["'nonsense'", "known: id, phase"]),
    "substeps without end": (SCENE + "[heat]\nsubsteps = 1_000_000_000\n", ["heat.substeps", "at most 10000 or auto"]),
    "end never reached": (
        SCENE.replace("end = 0.05", "end = 1e300"),
        ["2e+302 steps of time.dt = 0.005 s to t = 1e+300 s", "lower time.end"],
    ),
}


@pytest.mark.parametrize("command", ["plan", "run"])
@pytest.mark.parametrize("case", BAD_VALUES)
def test_a_bad_value_is_refused_and_leaves_no_file(case, command, tmp_path, scene):
    text, said = BAD_VALUES[case]
    scene.write_text(text)
    words = ["-o", tmp_path / "run.vtkhdf", "-b", "cpu"] if command == "run" else []
    refused(melt(command, scene, *words), *said)
    assert os.listdir(tmp_path) == ["drop.toml"]


def test_absolute_zero_and_the_known_fields_are_allowed(scene):
    fields = "id phase material position velocity density pressure temperature latent_energy".split()
    scene.write_text(SCENE + f'[fluid]\ntemperature = "0 K"\n[output]\nfields = {fields}\n')
    assert melt("show", scene).exit_code == 0
    assert melt("show", scene, "--set", "heat.substeps=10000").exit_code == 0


def test_an_end_that_is_never_reached_is_refused_on_the_command_line_too(tmp_path, scene):
    out = tmp_path / "run.vtkhdf"
    refused(melt("run", scene, "-o", out, "-b", "cpu", "--until", "1e300"), "2e+302 steps", "--until")
    assert not out.exists()


def test_resume_to_a_time_already_passed_is_refused(whole, tmp_path):
    path = tmp_path / "run.vtkhdf"
    shutil.copy(whole, path)
    shutil.copy(beside(whole), beside(path))
    refused(melt("resume", path, "--until", "0.04 s"), "is already at t = 0.05 s", "later --until")
    assert path.read_bytes() == whole.read_bytes()
    assert melt("resume", path, "--until", "0.05 s", "-q").exit_code == 0


@pytest.mark.parametrize("precision", ["single", "double"])
def test_a_time_step_too_small_is_refused_without_a_warning_of_numpy(precision, scene):
    dt = {"single": "1e-300", "double": "1e-309"}[precision]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = melt("plan", scene, "--set", f"time.dt={dt}", "--precision", precision)
    refused(result, f"time.dt = {dt} s is too small")


def test_a_run_is_not_written_under_the_name_of_a_picture(tmp_path):
    refused(melt("run", "ice_cube_small", "-o", tmp_path / "a.mp4"), "run writes a run file, not a .mp4", "a.vtkhdf")
    assert not list(tmp_path.iterdir())


def test_a_melting_point_without_heat_is_told(tmp_path):
    (tmp_path / "cold.toml").write_text(SCENE + SOLID.replace('"-500 degC"', "-5\nmelting_point = 0"))
    told = melt("plan", tmp_path / "cold.toml")
    assert told.exit_code == 0 and "nothing warms or melts" in told.stdout
