"""Bad scenes from the command line: one paragraph, exit code 1, and no file left behind."""

import os
import pathlib
import shutil

import numpy as np
import pytest
from small_runs import SCENE, alarmed, melt, refused

from melt.cli import FAILED
from melt.output.run_reader import open_run

OPEN_MESH = b"""solid s
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
facet normal 0 1 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 1
endloop
endfacet
endsolid s
"""
MESH = '\n[[solid]]\nshape = "mesh"\nposition = [0.4, 0.4, 1.0]\n'
BAD_SCENES = {
    "unknown section": (
        SCENE + "[fluids]\ndensity = 1\n",
        ["fluids is not a known key", "did you mean 'fluid'"],
    ),
    "unknown key of an item": (SCENE + "colour = 3\n", ["fluid.fill.0.colour is not a known key"]),
    "unit of another kind": (
        SCENE + '[fluid]\ndensity = "5 kg"\n',
        ["fluid.density", "is a mass, expected a density"],
    ),
    "wrong unit": (SCENE.replace("0.05", '"5 kg"', 1), ["time.end", "is a mass, expected a time"]),
    "no unit that exists": (SCENE.replace("0.05", '"5 parsec"', 1), ["time.end", "parsec"]),
    "negative density": (
        SCENE + "[[solid]]\nposition=[0,0,1]\nsize=[1,1,1]\ndensity=-917\n",
        ["solid.0.density = -917", "greater than 0"],
    ),
    "nan": (SCENE.replace("0.05", "nan", 1), ["time.end", "nan"]),
    "infinite": (SCENE.replace("0.05", "inf", 1), ["time.end", "inf"]),
    "text for a number": (SCENE.replace("0.05", '"soon"', 1), ["time.end", "soon"]),
    "a number for a table": (SCENE + "heat = 3\n", ["heat"]),
    "a list too short": (SCENE.replace("[0.8, 0.8, 1.2]", "[0.8, 1.2]"), ["domain.upper", "list of 3"]),
    "no domain": (SCENE.replace("domain", "output"), ["domain is required and missing"]),
    "no TOML": (SCENE + "[[[", ["not valid TOML"]),
    "no text": (b"\xff\xfe\x00\x01", ["cannot be read", "TOML text file"]),
    "empty": ("", ["time is required", "domain is required"]),
    "missing mesh": (SCENE + MESH + 'file = "nowhere.stl"\n', ["'nowhere.stl' does not exist"]),
    "mesh that is no mesh": (SCENE + MESH + 'file = "drop.toml"\n', ["drop.toml"]),
    "mesh that is not watertight": (
        SCENE + MESH + 'file = "open.stl"\n',
        ["open.stl: not watertight", "repair = true"],
    ),
    "step too long": (
        SCENE.replace("end = 0.05", "end = 5\ndt = 1"),
        ["time.n_sub_max is 16", "lower time.dt"],
    ),
    "too large": (SCENE.replace("1.2]", "1e9]"), ["lattice cells", "domain.spacing"]),
    "through the wall": (
        SCENE.replace("0.8, 0.8]", "0.8, -0.8]").replace("lower = [0, 0, 0]", "lower = [0, 0, -1]"),
        ["wall z-"],
    ),
}


@pytest.mark.parametrize("command", ["plan", "run"])
@pytest.mark.parametrize("case", BAD_SCENES)
def test_a_bad_scene_is_refused_and_leaves_no_file(case, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, said = BAD_SCENES[case]
    pathlib.Path("drop.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    pathlib.Path("open.stl").write_bytes(OPEN_MESH)
    result = melt(command, "drop.toml", *(["-o", "run.vtkhdf", "-b", "cpu"] if command == "run" else []))
    refused(result, *said)
    assert sorted(os.listdir()) == ["drop.toml", "open.stl"]


def test_a_folder_is_no_scene(tmp_path):
    refused(melt("run", tmp_path, "-b", "cpu"), "unknown scene")


def test_a_bad_scene_does_not_cost_the_older_run(whole, tmp_path, scene):
    path = tmp_path / "run.vtkhdf"
    shutil.copy(whole, path)
    before = path.read_bytes()
    result = melt("run", scene, "-o", path, "-f", "-b", "cpu", "--set", "time.dt=1", "--set", "time.end=5")
    refused(result, "time.n_sub_max")
    assert path.read_bytes() == before


def test_a_run_that_turns_bad_ends_with_its_frames_and_exit_code_1(tmp_path, scene):
    """A speed whose square float32 cannot hold."""
    path = tmp_path / "run.vtkhdf"
    words = ["time.n_sub=1", "fluid.fill.0.velocity=[0, 0, 1e19]", "watch.speed=off", "time.end=2"]
    result = melt("run", scene, "-o", path, "-b", "cpu", *[w for s in words for w in ("--set", s)])
    alarmed(result, "step 1, t = 0.005 s", "Stage motion_bounds", "frames before are kept")
    assert "is not finite" in result.stderr
    with open_run(path) as run:
        assert len(run) == 1 and np.isfinite(run.frame(0)["position"]).all()
    assert melt("info", path).exit_code == 0


def test_an_unstable_run_that_stays_finite_says_what_it_lost(tmp_path, scene):
    """A sound speed far too large for one fixed sub-step throws the liquid out of the box."""
    words = ["time.n_sub=1", "fluid.sound_speed=1e6", "time.end=0.2"]
    result = melt(
        "run", scene, "-o", tmp_path / "run.vtkhdf", "-b", "cpu", *[w for s in words for w in ("--set", s)]
    )
    notes = [line for line in result.stderr.splitlines() if line.startswith("note: ")]
    assert any(
        "time.n_sub = 1 makes sub-steps of 0.005 s" in note and "Fix: time.n_sub = " in note for note in notes
    )
    assert (
        sum("particles are outside of the domain" in note for note in notes) == 1
        or result.exit_code == FAILED
    )
