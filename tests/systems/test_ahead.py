"""What is compiled before a run is what the run then calls, whoever else compiles at the same time."""

import os
import pathlib
import subprocess
import sys

import pytest
from numba import typeof

from melt import _compile, ahead
from melt.bind import Plain
from melt.scene import load_scene
from melt.simulation import Simulation

SCENES = {
    "ice_cube_small": ["solid.0.position=[1.5, 1.3, 1.5]"], "two_jets_small": [], "stefan_front_small": [],
    "dam_break_small": ["solver.neighbours=kdtree"],
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("precision", ("single", "mixed"))
def test_every_call_was_foreseen(name, precision, monkeypatch):
    called = set()

    def call(self, stage, arguments):
        called.add((stage.name, tuple(typeof(a) for a in arguments)))
        plain(self, stage, arguments)

    plain = Plain._call
    monkeypatch.setattr(Plain, "_call", call)
    simulation = Simulation(load_scene(name, SCENES[name]), "cpu", precision)
    for _ in range(2):
        simulation.step()
    foreseen = set(ahead.signatures(simulation.do, simulation.prepared.stages, simulation.prepared.renamed))
    assert called and called <= foreseen, called - foreseen


def test_nothing_is_compiled_for_other_backends():
    do = Simulation(load_scene("stefan_front_small"), "reference").do
    assert ahead.compile_ahead(do, ["density"]) == 0


CODE = """
from melt import ahead
from melt.scene import load_scene
from melt.simulation import Simulation
heard = []
sim = Simulation(load_scene("stefan_front_small"), "cpu", progress=lambda event, **v: heard.append(event))
ahead._ready.clear()
assert "warning" not in heard
assert not ahead._missing(ahead.signatures(sim.do, sim.prepared.stages, sim.prepared.renamed))
print(len(heard))
"""


def start(folder, cache):
    root = str(pathlib.Path(ahead.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": root, "MELT_CACHE_DIR": str(cache), "MELT_PARALLEL": "0"}
    return subprocess.Popen(
        [sys.executable, "-c", CODE], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def test_two_cold_runs_at_once_leave_a_whole_cache(tmp_path):
    runs = [start(tmp_path.parent, tmp_path / "cache") for _ in range(2)]
    heard = []
    for run in runs:
        out, err = run.communicate()
        assert run.returncode == 0, err
        heard.append(int(out))
    assert min(heard) == 0 < max(heard), "one compiled, the other waited and loaded"
    again = start(tmp_path.parent, tmp_path / "cache")
    out, err = again.communicate()
    assert again.returncode == 0 and int(out) == 0, err  # all there: nothing to say


def test_a_cache_that_cannot_be_written_is_done_without(monkeypatch):
    def refuse(**where):
        raise PermissionError("made by root, as in an image")

    assert _compile.prepare_cache() == _compile.CACHED
    monkeypatch.setattr(_compile.tempfile, "TemporaryFile", refuse)
    assert not _compile.prepare_cache()


def test_folders_of_versions_unused_for_a_month_are_dropped(tmp_path, monkeypatch):
    names = {"old": "0123456789abcdef-serial", "young": "fedcba9876543210", "foreign": "pictures"}
    for name in names.values():
        (tmp_path / name).mkdir()
        os.utime(tmp_path / name, (0, 0))
    os.utime(tmp_path / names["young"])
    monkeypatch.setattr(_compile, "CACHE_FOLDER", tmp_path / "00000000000000ff")
    assert _compile.prepare_cache()
    assert sorted(f.name for f in tmp_path.iterdir()) == ["00000000000000ff", names["young"], names["foreign"]]
