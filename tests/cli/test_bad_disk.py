"""Places that cannot be written and full disks: one paragraph, exit code 1, completed frames kept."""

import itertools
import os
import shutil
import subprocess

import numpy as np
import pytest
from small_runs import melt, refused

from melt.cli import progress
from melt.output.checkpoint import beside
from melt.output.run_reader import open_run


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("nowhere/run.vtkhdf", "the folder does not exist"),
        ("drop.toml/run.vtkhdf", "cannot create"),
        ("folder", "exists already"),
        ("x" * 300 + ".vtkhdf", "cannot create"),
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_the_run(place, said, tmp_path, scene):
    (tmp_path / "folder").mkdir()
    refused(melt("run", scene, "-o", tmp_path / place, "-b", "cpu"), said)
    assert sorted(os.listdir(tmp_path)) == ["drop.toml", "folder"]


def test_a_folder_is_not_replaced_by_a_run(tmp_path, scene):
    (tmp_path / "folder").mkdir()
    refused(melt("run", scene, "-o", tmp_path / "folder", "-f", "-b", "cpu"), "this is a folder")
    assert sorted(os.listdir(tmp_path)) == ["drop.toml", "folder"]


class Disk:
    """A small tmpfs. Root is refused by no folder's permissions, but by a read-only mount."""

    def __init__(self, path):
        self.path = path

    def mount(self, *options):
        command = ["mount", "-t", "tmpfs", "-o", ",".join(options), "tmpfs", str(self.path)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def again(self, *options):
        """Mount it anew with other options; its files stay."""
        subprocess.run(["mount", "-o", ",".join(("remount", *options)), str(self.path)], check=True)


@pytest.fixture
def disk(tmp_path):
    """A tmpfs of 1 MB, unmounted afterwards."""
    if os.name != "posix" or os.geteuid() != 0 or shutil.which("mount") is None:
        pytest.skip("a small or read-only file system can be mounted by root only")
    disk = Disk(tmp_path / "disk")
    disk.path.mkdir()
    done = disk.mount("size=1m")
    if done.returncode:
        pytest.skip(f"tmpfs cannot be mounted here: {done.stderr.strip()}")
    try:
        yield disk
    finally:
        subprocess.run(["umount", str(disk.path)], check=True)


@pytest.fixture
def read_only(disk, whole):
    """A read-only folder with a run in it."""
    shutil.copy(whole, disk.path / "old.vtkhdf")
    shutil.copy(beside(whole), beside(disk.path / "old.vtkhdf"))
    disk.again("ro")
    return disk.path


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "SCENE", "-o", "FOLDER/run.vtkhdf", "-b", "cpu"], "cannot create"),
        (["run", "SCENE", "-o", "FOLDER/old.vtkhdf", "-f", "-b", "cpu"], "cannot create"),
        (["resume", "FOLDER/old.vtkhdf"], "cannot continue"),
        (["render", "FOLDER/old.vtkhdf"], "cannot write"),
        (["render", "FOLDER/old.vtkhdf", "-o", "FOLDER/a.ply"], "cannot write"),
        (["render", "FOLDER/old.vtkhdf", "-o", "FOLDER/a.mp4"], "cannot write"),
    ],
)
def test_a_read_only_folder_is_said_to_be_one(words, said, read_only, scene):
    words = [w.replace("SCENE", str(scene)).replace("FOLDER", str(read_only)) for w in words]
    refused(melt(*words), said, "read-only", "--output")
    assert sorted(os.listdir(read_only)) == ["old.vtkhdf", "old.vtkhdf.ckpt"]


def test_a_run_in_a_read_only_folder_can_be_looked_at(read_only, tmp_path):
    assert melt("info", read_only / "old.vtkhdf").exit_code == 0
    assert melt("render", read_only / "old.vtkhdf", "-o", tmp_path / "a.png", "-q").exit_code == 0


@pytest.mark.skipif(
    os.name != "posix" or os.geteuid() == 0, reason="root is refused by no folder's permissions"
)
def test_a_folder_without_permission_is_said_to_be_one(tmp_path, scene):
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o555)
    refused(melt("run", scene, "-o", folder / "run.vtkhdf", "-b", "cpu"), "no permission to write there")


@pytest.fixture(params=["at once", "slow"])
def speed(request, monkeypatch):
    """What a run's clock shows: no time at all, or three seconds more at each look, so that lines of progress come."""
    looks = itertools.count()
    monkeypatch.setattr(progress, "_now", lambda: 3.0 * next(looks) if request.param == "slow" else 0.0)
    return request.param


def vtk_counts(path):
    """Return the number of points of every frame, read by VTK."""
    import vtk

    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    counts = []
    for k in range(reader.GetNumberOfSteps()):
        reader.SetStep(k)
        reader.Update()
        counts.append(reader.GetOutputDataObject(0).GetNumberOfPoints())
    return counts


@pytest.mark.parametrize("kilobytes", [164, 200, 240, 280, 320])
def test_a_full_disk_keeps_all_completed_frames_and_the_run_goes_on_when_there_is_space(
    kilobytes, disk, scene, whole, speed
):
    disk.again(f"size={kilobytes}k")
    path = disk.path / "run.vtkhdf"
    result = melt("run", scene, "-o", path, "-b", "cpu")
    refused(result, "disk is full", "melt resume")
    assert ("\nstep 1 of 10 (10%), t = 0.005 s, " in result.stderr) == (speed == "slow")
    left = sorted(os.listdir(disk.path))
    assert left in (["run.vtkhdf"], ["run.vtkhdf", "run.vtkhdf.ckpt"])  # no part of a file
    with open_run(path) as run, open_run(whole) as right:
        frames = len(run)
        assert 1 <= frames <= 6
        assert "frames" not in result.stderr or f"all {frames} earlier frames" in result.stderr
        for k in range(frames):
            for field in right.fields:
                assert np.array_equal(run.frame(k)[field], right.frame(k)[field])
    assert vtk_counts(path) == [64] * frames
    assert melt("info", path).exit_code == 0
    disk.again("size=2m")
    if beside(path).exists():
        assert melt("resume", path, "-q").exit_code == 0
        with open_run(path) as run, open_run(whole) as right:
            assert len(run) == 6 and np.array_equal(run.frame(5)["position"], right.frame(5)["position"])
    else:
        refused(melt("resume", path), "checkpoint")


def test_a_disk_too_full_for_the_first_frame_is_left_as_it_was(disk, scene):
    (disk.path / "ballast").write_bytes(bytes(1_000_000 // 4096 * 4096))
    refused(melt("run", scene, "-o", disk.path / "run.vtkhdf", "-b", "cpu"), "disk is full")
    assert os.listdir(disk.path) == ["ballast"]


@pytest.mark.parametrize("name", ["a.png", "a.ply", "a.mp4"])
def test_a_disk_too_full_for_a_picture_is_left_as_it_was(name, disk, whole):
    free = shutil.disk_usage(disk.path).free
    (disk.path / "ballast").write_bytes(bytes(free))
    refused(melt("render", whole, "-o", disk.path / name, "-q"), "disk")
    assert os.listdir(disk.path) == ["ballast"]
