"""The command line: listings, refusals in one paragraph, exit codes, a run from end to end, Ctrl-C."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import h5py
import pytest
from small_runs import frames
from typer.testing import CliRunner

import melt.scene
from melt.cli import DIFFERENT, FAILED, INTERNAL, INTERRUPTED, app
from melt.scene import shipped_scenes

SMALL = """
[scene]
name = "drop"
[time]
end = 0.05
output_every = 0.01
checkpoint_every = 0.02
[domain]
upper = [0.8, 0.8, 1.2]
[[fluid.fill]]
lower = [0, 0, 0]
upper = [0.8, 0.8, 0.8]
"""


@pytest.fixture
def cli():
    runner = CliRunner()

    def run(*words):
        return runner.invoke(app, list(words), prog_name="melt")

    return run


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "drop.toml"
    path.write_text(SMALL)
    return str(path)


def test_scenes_lists_every_shipped_scene_with_what_it_stands_for(cli):
    result = cli("scenes")
    assert result.exit_code == 0
    for name in shipped_scenes():
        assert name in result.stdout
    assert "Figure 4" in result.stdout
    assert cli("scenes", "--names").stdout.split() == list(shipped_scenes())


def test_schema_is_json(cli):
    schema = json.loads(cli("schema").stdout)
    assert schema["$schema"].startswith("https://json-schema.org/")
    of = {key: schema["$defs"][schema[key]["$ref"].rpartition("/")[2]] for key in ("then", "else")}
    assert schema["if"] == {"required": ["terrain"]}
    assert {"heat", "domain", "presets"} <= set(of["else"]["properties"]) and "terrain" not in of["else"]["properties"]
    assert {"terrain", "control", "gauge", "presets"} <= set(of["then"]["properties"]) and "domain" not in of["then"]["properties"]
    assert not any(scene["additionalProperties"] for scene in of.values())


def test_show_prints_every_value_in_force(cli):
    result = cli("show", "ice_cube", "--set", "heat.conductivity=50", "--preset", "paper")
    assert "conductivity = 50.0" in result.stdout and "mirror = 0.0" in result.stdout


def test_plan_lists_what_the_scene_requires_and_no_more(cli):
    with_heat = cli("plan", "ice_cube_small")
    assert with_heat.exit_code == 0, with_heat.output
    assert "temperature" in with_heat.stdout and "tait_pressure" in with_heat.stdout
    without = cli("plan", "tank_small")
    assert without.exit_code == 0 and "temperature" not in without.stdout


@pytest.mark.parametrize(
    "word", [[], ["--help"], *([c, "--help"] for c in ("run", "plan", "check", "render"))]
)
def test_help_is_given(cli, word):
    result = cli(*word)
    assert "Usage: melt" in result.output
    assert result.exit_code in (0, 2)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "ice_cub"], "did you mean ice_cube"),
        (["plan", "ice_cube", "--set", "fluid.densty=5"], "did you mean 'density'"),
        (["plan", "ice_cube", "--set", "heat.wall_temperature=5 kg"], "is a mass, expected a temperature"),
        (["plan", "ice_cube", "--preset", "papr"], "did you mean paper"),
        (["run", "tank_small", "--backend", "gpu"], "unknown backend 'gpu'"),
        (["run", "tank_small", "--precision", "half"], "unknown precision 'half'"),
        (["plan", "tank_small", "--precision", "half"], "unknown precision 'half'"),
        (["run", "tank_small", "--until", "3 kg"], "expected a time"),
        (["run", "tank_small", "--until", "-1"], "time of 0 s or more"),
        (["check", "densty"], "did you mean density"),
        (["check", "density", "--backend", "gpu"], "unknown backend"),
        (["resume", "nowhere.vtkhdf"], "nowhere.vtkhdf"),
        (["info", "nowhere.vtkhdf"], "nowhere.vtkhdf"),
        (["tradeoff", "ice_cub"], "did you mean ice_cube"),
        (["render", "nowhere.vtkhdf"], "nowhere.vtkhdf"),
        (["render", "nowhere.vtkhdf", "--size", "big"], "WIDTHxHEIGHT"),
        (["reproduce", "table_99"], "unknown table 'table_99'"),
    ],
)
def test_mistake_gives_one_paragraph_and_exit_code_1(cli, words, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = cli(*words)
    assert result.exit_code == FAILED, result.output
    assert result.stderr.startswith("melt: ") and said in result.stderr
    assert result.stderr.strip().count("\n") == 0
    assert not list(tmp_path.glob("*.vtkhdf"))


def test_debug_shows_the_traceback_wherever_it_stands(cli):
    for words in (["plan", "ice_cub", "--debug"], ["--debug", "plan", "ice_cub"]):
        result = cli(*words)
        assert (
            result.exit_code == FAILED
            and "Traceback" in result.stderr
            and "melt: unknown scene" in result.stderr
        )
    assert "Traceback" not in cli("plan", "ice_cub").stderr


def test_wrong_usage_is_exit_code_2(cli):
    assert cli("run").exit_code == 2
    assert cli("run", "ice_cube", "--colour").exit_code == 2
    assert cli("flood").exit_code == 2


def test_fault_of_melt_is_said_to_be_one(cli, monkeypatch):
    monkeypatch.setattr("melt.scene.load_scene", lambda *a: 1 / 0)
    result = cli("show", "ice_cube")
    assert result.exit_code == INTERNAL
    assert (
        "ZeroDivisionError" in result.stderr
        and "--debug" in result.stderr
        and "Traceback" not in result.stderr
    )


def test_check_with_a_difference_is_exit_code_3(cli, monkeypatch):
    from melt.check import report

    seen = {}
    monkeypatch.setattr(report, "main", lambda *a, **k: seen.update(args=a, **k) or 1)
    assert cli("check", "density", "--backend", "cpu", "--precision", "double").exit_code == DIFFERENT
    assert seen["args"][:3] == (["density"], ("cpu",), ("double",))
    monkeypatch.setattr(report, "main", lambda *a, **k: 0)
    assert cli("check").exit_code == 0


def test_run_writes_its_file_and_does_not_replace_it_unasked(cli, small, tmp_path):
    out = tmp_path / "drop.vtkhdf"
    first = cli("run", small, "-o", str(out), "--backend", "cpu", "--until", "0.02 s")
    assert first.exit_code == 0, first.output
    assert "3 frames" in first.stderr and first.stdout == ""
    with h5py.File(out) as file:
        assert file["VTKHDF/Steps/Values"].shape == (3,)
        text = (
            file["melt/scene"][()]
            if isinstance(file["melt/scene"], h5py.Dataset)
            else file["melt"].attrs["scene"]
        )
    assert melt.scene.scene_from_toml(text.decode() if isinstance(text, bytes) else text).scene.name == "drop"
    told = cli("info", str(out))
    assert told.exit_code == 0 and any(line.split() == ["scene", "drop"] for line in told.stdout.splitlines())
    before = out.read_bytes()
    again = cli("run", small, "-o", str(out), "--backend", "cpu", "--until", "0.02 s")
    assert again.exit_code == FAILED and "exists already" in again.stderr and out.read_bytes() == before
    replaced = cli("run", small, "-o", str(out), "-f", "--backend", "cpu", "--until", "0.01 s", "--quiet")
    assert replaced.exit_code == 0 and replaced.output == ""


def test_run_resumes_from_the_command_line(cli, small, tmp_path):
    out = tmp_path / "drop.vtkhdf"
    assert cli("run", small, "-o", str(out), "-b", "cpu", "--until", "0.02 s", "-q").exit_code == 0
    result = cli("resume", str(out))
    assert result.exit_code == 0, result.output
    with h5py.File(out) as file:
        assert file["VTKHDF/Steps/Values"][()] == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04, 0.05])


def test_ctrl_c_ends_with_a_whole_file(small, tmp_path):
    out = tmp_path / "long.vtkhdf"
    source = pathlib.Path(melt.scene.__file__).parents[2]
    command = [sys.executable, "-m", "melt", "run", small, "-o", str(out), "-b", "cpu", "--until", "1000 s"]
    environment = {**os.environ, "PYTHONPATH": str(source)}
    process = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)
    try:
        deadline = time.monotonic() + 120
        while process.poll() is None and time.monotonic() < deadline:
            if frames(out) > 2:
                break
            time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == INTERRUPTED, said
    assert "melt resume" in said and "Traceback" not in said
    assert frames(out) > 2
