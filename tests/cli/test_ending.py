"""How a run ended: recorded in its file, told by ``melt info``; ``melt resume --on-unstable``."""

import shutil
import signal

import h5py
import pytest
from small_runs import alarmed, melt, refused

from melt import simulation
from melt.output import checkpoint
from melt.output.errors import OutputError
from melt.output.run_file import RunWriter
from melt.output.run_reader import open_run


def ended(path):
    """Return what info says of the end of a run."""
    result = melt("info", path)
    assert result.exit_code == 0, result.output
    lines = [line for line in result.stdout.splitlines() if line.startswith("ended ")]
    assert len(lines) == 1, result.output
    return lines[0].removeprefix("ended").strip()


@pytest.fixture
def fast(scene, tmp_path):
    """A run that an alarm stopped after its first checkpoint, and the command that ran it."""
    path = tmp_path / "fast.vtkhdf"
    return path, melt("run", scene, "-o", path, "-b", "cpu", "--set", "watch.speed=0.2 m/s")


def test_a_whole_run_is_complete(whole):
    assert ended(whole) == "complete, step 10, t = 0.05 s"


def test_a_run_to_an_earlier_end_says_so_and_continued_it_is_complete(scene, tmp_path):
    path = tmp_path / "part.vtkhdf"
    melt("run", scene, "-o", path, "-b", "cpu", "--until", "0.02")
    assert ended(path) == "complete, step 4, t = 0.02 s, as far as asked for, of 0.05 s in all"
    melt("resume", path)
    assert ended(path) == "complete, step 10, t = 0.05 s"


def test_an_alarm_is_told_with_its_reason_and_its_capsule_until_the_run_goes_on(fast):
    path, result = fast
    lines = alarmed(result, "beyond the alarm of 0.2 m/s", "Stage ", "melt check --capsule")
    assert ended(path) == f"stopped by an alarm, {lines[0]} Capsule: fast.vtkhdf.capsule.h5."
    with open_run(path) as run:
        assert run.end["how"] == "alarm" and f"step {run.end['step']}, " in lines[0] and run.end["time"] < 0.05
        frames = len(run)
    RunWriter.resume(path).close()  # as a run that was continued, and killed at once
    assert ended(path) == "unfinished: it still runs, or was killed; melt resume goes on from its checkpoint"
    assert len(open_run(path)) == frames


def test_an_interrupted_run_is_told_and_one_that_is_still_running(scene, tmp_path):
    path, copy = tmp_path / "stopped.vtkhdf", tmp_path / "copy.vtkhdf"

    def progress(event, step=0, **_):
        if event == "step" and step == 6:
            shutil.copy(path, copy)
            signal.raise_signal(signal.SIGINT)

    simulation.run(scene, path, backend="cpu", progress=progress)
    assert ended(path) == "interrupted, step 6, t = 0.03 s; melt resume goes on from its checkpoint"
    assert ended(copy) == "unfinished: it still runs, or was killed"


@pytest.mark.parametrize(("error", "said"), [
    (OutputError("cannot write checkpoint x: the disk is full."), "cannot write checkpoint x: the disk is full."),
    (ValueError("oops"), "ValueError: oops"),
])  # fmt: skip
def test_an_error_is_told(error, said, scene, tmp_path, monkeypatch):
    def fails(*_):
        raise error

    monkeypatch.setattr(checkpoint, "save", fails)
    with pytest.raises(type(error)):
        simulation.run(scene, tmp_path / "run.vtkhdf", backend="cpu")
    with open_run(tmp_path / "run.vtkhdf") as run:
        when = f"step {run.end['step']}, t = {run.times[-1]:g} s"
    assert ended(tmp_path / "run.vtkhdf") == f"stopped by an error, {when}: {said}"


def test_an_end_that_cannot_be_recorded_does_not_hide_the_alarm(scene, tmp_path, monkeypatch):
    def full(*_, **__):
        raise OutputError("the disk is full")

    monkeypatch.setattr(RunWriter, "end", full)
    alarmed(melt("run", scene, "-o", tmp_path / "run.vtkhdf", "-b", "cpu", "--set", "watch.speed=0.2 m/s"), "beyond the alarm of 0.2 m/s")
    refused(melt("run", scene, "-o", tmp_path / "other.vtkhdf", "-b", "cpu"), "the disk is full")


def test_a_file_of_an_earlier_version_says_nothing_of_its_end(whole, tmp_path):
    path = tmp_path / "old.vtkhdf"
    shutil.copy(whole, path)
    with h5py.File(path, "r+", locking=False) as file:
        del file["melt/end"]
    assert ended(path) == "not recorded: the file is of an earlier version"


def test_resume_halves_steps_if_asked_to_and_is_refused_other_answers(fast):
    path, _ = fast
    refused(melt("resume", path, "--on-unstable", "pray"), "use stop or halve")
    again = melt("resume", path)
    alarmed(again, "beyond the alarm of 0.2 m/s", "--on-unstable halve")
    assert "Back to t =" not in again.stderr
    halved = melt("resume", path, "--on-unstable", "halve")
    assert halved.stderr.count("      Back to t =") == 4 and "halved 4 times (watch.halvings), do not help" in halved.stderr
