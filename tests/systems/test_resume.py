"""A killed run keeps its frames, and resume continues it bit by bit."""

import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from scene_runs import datasets

from melt import simulation
from melt.errors import MeltError
from melt.output.run_reader import open_run
from melt.scene import load_scene

OVERRIDES = ["time.end=0.5", "time.output_every=0.05", "solid.0.position=[1.5, 1.3, 1.5]"]


def scene():
    return load_scene("ice_cube_small", OVERRIDES)


def in_child(statement, wait=True, **environment):
    """Run ``statement`` in a process of its own."""
    code = (
        "from melt import simulation; from melt.scene import load_scene; "
        f"scene = load_scene('ice_cube_small', {OVERRIDES!r}); {statement}"
    )
    root = str(pathlib.Path(simulation.__file__).parents[1])
    child = subprocess.Popen([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": root, **environment})
    if wait:
        assert child.wait() == 0
    return child


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run whose stages were not in the cache: those it is compared with load them (see `melt.ahead`)."""
    folder = tmp_path_factory.mktemp("whole")
    cold = str(tmp_path_factory.mktemp("cache"))
    in_child(f"simulation.run(scene, {str(folder / 'run.vtkhdf')!r}, backend='cpu')", MELT_CACHE_DIR=cold)
    return folder / "run.vtkhdf"


def _same(a, b):
    a, b = datasets(a), datasets(b)
    assert set(a) == set(b)
    return [name for name in a if not np.array_equal(a[name], b[name], equal_nan=a[name].dtype.kind == "f")]


def test_a_run_melts_something(whole):
    assert open_run(whole).series["melted_fraction"][-1] > 0.1  # else the test of resume says little


def test_two_runs_are_bit_identical(whole, tmp_path):
    in_child(f"simulation.run(scene, {str(tmp_path / 'again.vtkhdf')!r}, backend='cpu')")
    assert _same(whole, tmp_path / "again.vtkhdf") == []


def test_resume_after_until_equals_an_uninterrupted_run(whole, tmp_path):
    path = tmp_path / "part.vtkhdf"
    in_child(f"simulation.run(scene, {str(path)!r}, backend='cpu', until=0.2)")
    assert len(open_run(path)) < len(open_run(whole))
    in_child(f"simulation.resume({str(path)!r})")
    assert _same(whole, path) == []


def test_kill_9_keeps_frames_that_vtk_reads_and_resume_is_bit_identical(whole, tmp_path):
    import vtk

    path = tmp_path / "killed.vtkhdf"
    child = in_child(f"simulation.run(scene, {str(path)!r}, backend='cpu')", wait=False)
    try:
        until = time.time() + 300
        while time.time() < until and child.poll() is None:
            if path.exists() and pathlib.Path(f"{path}.ckpt").exists() and len(open_run(path)) >= 3:
                break
            time.sleep(0.01)
        assert child.poll() is None, "the run ended before it could be killed"
        child.send_signal(signal.SIGKILL)
    finally:
        child.kill()
        child.wait()
    frames = len(open_run(path))
    assert 3 <= frames < len(open_run(whole))
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == frames
    for k in range(frames):
        reader.SetStep(k)
        reader.Update()
        assert reader.GetOutputDataObject(0).GetNumberOfPoints() == len(open_run(path).frame(k)["id"])
    in_child(f"simulation.resume({str(path)!r})")
    assert _same(whole, path) == []


def test_ctrl_c_ends_after_the_step_with_a_readable_file(tmp_path):
    path = tmp_path / "stopped.vtkhdf"

    def progress(event, step=0, **_):
        if event == "step" and step == 20:
            signal.raise_signal(signal.SIGINT)

    result = simulation.run(scene(), path, backend="cpu", progress=progress)
    assert result.interrupted
    assert result.simulation.do.clock.step == 20
    assert len(open_run(path)) == 3
    simulation.resume(path, until=0.15)
    assert open_run(path).times[-1] == pytest.approx(0.15)


def test_resume_without_checkpoint_says_so(tmp_path, whole):
    lonely = tmp_path / "lonely.vtkhdf"
    lonely.write_bytes(whole.read_bytes())
    with pytest.raises(MeltError, match="checkpoint"):
        simulation.resume(lonely)
