"""What --overwrite may replace, and when: an older run goes only when the first frame of the new one is there."""

import os
import shutil
import socket
import stat

import pytest
from small_runs import SCENE, melt, refused

from melt import simulation
from melt.cli import INTERRUPTED, TERMINATED
from melt.errors import MeltError
from melt.interrupt import Terminated
from melt.output.checkpoint import beside
from melt.output.run_reader import open_run


@pytest.fixture
def older(whole, tmp_path):
    """An older run with its checkpoint, in a folder that also has the scene."""
    path = tmp_path / "run.vtkhdf"
    shutil.copy(whole, path)
    shutil.copy(beside(whole), beside(path))
    return path


def _content(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("text", [b"notes of a year", b"\x89HDF\r\n\x1a\nnot of melt" + bytes(99)])
def test_another_kind_of_file_is_left_alone(text, tmp_path, scene):
    path = tmp_path / "notes.txt"
    path.write_bytes(text)
    refused(melt("run", scene, "-o", path, "-f", "-b", "cpu"), "notes.txt was left as it is", "--overwrite", "--output")
    assert _content(tmp_path) == {"drop.toml": SCENE.encode(), "notes.txt": text}


@pytest.mark.parametrize("force", [[], ["-f"]])
def test_the_scene_file_is_left_alone(force, tmp_path, scene):
    refused(melt("run", scene, "-o", scene, *force, "-b", "cpu"), "is the scene file itself")
    assert _content(tmp_path) == {"drop.toml": SCENE.encode()}


@pytest.mark.skipif(os.name != "posix", reason="pipes and sockets with a name")
@pytest.mark.parametrize("kind", ["pipe", "socket", "device"])
def test_what_is_no_regular_file_is_left_alone(kind, tmp_path, scene):
    path = tmp_path / "special"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "socket":
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(os.path.relpath(path))
        listener.close()
    else:
        try:
            os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 3))  # a second null device, in this folder only
        except PermissionError:
            pytest.skip("only root makes device nodes")
    before = os.lstat(path)
    refused(melt("run", scene, "-o", path, "-f", "-b", "cpu"), "a device, a pipe or a socket", "was left as it is")
    assert os.path.samestat(before, os.lstat(path)) and sorted(os.listdir(tmp_path)) == ["drop.toml", "special"]


def test_a_link_is_followed_to_its_run(older, tmp_path, scene):
    link = tmp_path / "link.vtkhdf"
    link.symlink_to(older.name)
    words = ["--set", "time.end=0.01", "-b", "cpu", "-q"]
    assert melt("run", scene, "-o", link, "-f", *words).exit_code == 0
    assert link.is_symlink() and len(open_run(older)) == 2
    assert sorted(os.listdir(tmp_path)) == ["drop.toml", "link.vtkhdf", "run.vtkhdf", "run.vtkhdf.ckpt"]
    assert melt("resume", link, "-q").exit_code == 0  # its checkpoint is beside the target
    other = tmp_path / "other.vtkhdf"
    other.symlink_to("drop.toml")
    refused(melt("run", scene, "-o", other, "-f", *words), "is the scene file itself")
    assert other.is_symlink() and scene.read_text() == SCENE


def test_a_finished_and_an_empty_file_are_replaced(older, tmp_path, scene):
    words = ["--set", "time.end=0.01", "-b", "cpu", "-q", "-f"]
    (tmp_path / "empty").touch()
    for path in (older, tmp_path / "empty"):
        assert melt("run", scene, "-o", path, *words).exit_code == 0
        assert len(open_run(path)) == 2


def test_a_second_backend_that_does_not_exist_costs_nothing(older, tmp_path, scene):
    before = _content(tmp_path)
    refused(melt("run", scene, "-o", older, "-f", "-b", "cpu", "--lockstep", "nonsense"), "unknown backend 'nonsense'")
    assert _content(tmp_path) == before


def _fails(error):
    def compile_ahead(*_):
        raise error

    return compile_ahead


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize(("stop", "code"), [(KeyboardInterrupt, INTERRUPTED), (Terminated, TERMINATED)])
def test_a_stop_while_stages_compile_leaves_the_older_run(stop, code, there, older, tmp_path, scene, monkeypatch):
    monkeypatch.setattr(simulation, "compile_ahead", _fails(stop()))
    before = _content(tmp_path)
    path = older if there else tmp_path / "new.vtkhdf"
    result = melt("run", scene, "-o", path, "-f", "-b", "cpu")
    assert result.exit_code == code and _content(tmp_path) == before
    said = result.stderr.strip().splitlines()[-1]
    assert said.startswith("melt: stopped before the first frame: nothing was written")
    assert said.endswith(f"; the earlier {older} is untouched") == there and "completed frames" not in said


def test_a_run_that_fails_to_start_leaves_the_older_run(older, tmp_path, scene, monkeypatch):
    monkeypatch.setattr(simulation, "compile_ahead", _fails(MeltError("no compiler")))
    before = _content(tmp_path)
    refused(melt("run", scene, "-o", older, "-f", "-b", "cpu"), "no compiler")
    assert _content(tmp_path) == before


def test_a_stop_after_the_first_frame_does_not_say_that_nothing_was_written(older, scene, monkeypatch):
    monkeypatch.setattr(simulation, "loop", _fails(KeyboardInterrupt()))
    result = melt("run", scene, "-o", older, "-f", "-b", "cpu")
    assert result.exit_code == INTERRUPTED and "files hold all completed frames" in result.stderr
    assert len(open_run(older)) == 1 and not beside(older).exists()
