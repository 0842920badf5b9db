"""A run file is whole at every instant: after every page written, after real kills, on a full disk."""

import errno
import os
import random
import resource
import signal
import time

import pytest
from run_samples import particles, same, vtk_frames

from melt.output import hdf5
from melt.output.errors import OutputError
from melt.output.run_file import RunWriter
from melt.output.run_reader import open_run

PAGE = 4096
COUNTS = [40, 0, 1500, 900]


class Recorder:
    """Stands in for ``os`` in `melt.output.hdf5`: notes every change of the file, page by page."""

    def __init__(self, fail_at=None, code=errno.ENOSPC):
        self.log, self.fail_at, self.code = [], fail_at, code

    def __getattr__(self, name):
        return getattr(os, name)

    def pwrite(self, descriptor, data, offset):
        # the kernel can be interrupted between two pages, so a write comes in pieces
        piece = bytes(data)[: PAGE - offset % PAGE]
        if self.fail_at is not None and len(self.log) >= self.fail_at:
            raise OSError(self.code, os.strerror(self.code))
        self.log.append((offset, piece))
        return os.pwrite(descriptor, piece, offset)

    def ftruncate(self, descriptor, size):
        self.log.append((size, None))
        os.ftruncate(descriptor, size)


def replay(image, entry):
    offset, data = entry
    if data is None:
        del image[offset:]
        image.extend(bytes(offset - len(image)))
    else:
        image.extend(bytes(max(0, offset + len(data) - len(image))))
        image[offset : offset + len(data)] = data


def append(writer, k, n):
    writer.append(0.1 * k, particles(k, n), {"kinetic_energy": 1.0 * k})


def check(path, frames):
    with open_run(path) as run:
        assert len(run) == frames == len(run.series.get("kinetic_energy", []))
        for k in range(frames):
            assert same(run.frame(k), particles(k, COUNTS[k]))


def test_every_prefix_of_the_writes_is_a_whole_file(tmp_path, monkeypatch):
    """Stop after every page written while four frames are appended, two cut off, and two appended."""
    path, torn = tmp_path / "a.vtkhdf", tmp_path / "torn.vtkhdf"
    writer = RunWriter(path, "[scene]", {})
    image, recorder = bytearray(path.read_bytes()), Recorder()
    monkeypatch.setattr(hdf5, "os", recorder)
    for k, n in enumerate(COUNTS):
        append(writer, k, n)
    writer.close()
    writer = RunWriter.resume(path, frames=2)
    middle = len(recorder.log)
    for k in (2, 3):
        append(writer, k, COUNTS[k])
    writer.close()
    monkeypatch.undo()

    seen = []
    for number, entry in enumerate(recorder.log):
        replay(image, entry)
        torn.write_bytes(image)
        with open_run(torn) as run:
            frames = len(run)
        check(torn, frames)
        if number % 7 == 0 or frames != (seen or [0])[-1]:
            assert len(vtk_frames(torn)) == frames
        seen.append(frames)
    assert len(seen) > 200
    # frames appear one by one, at the last write of an append; the cut happens at once
    changes = [f for i, f in enumerate(seen) if i == 0 or f != seen[i - 1]]
    assert changes == [0, 1, 2, 3, 4, 2, 3, 4]
    assert seen[middle - 1] == 2
    assert bytes(image) == path.read_bytes()


def write_forever(path, report, pause):
    """What a killed run does; reports each frame that `append` has returned from."""
    writer = RunWriter(path, "[scene]", {}, sync=False)
    k = 0
    while True:
        append(writer, k, 10 + 37 * k % 3000)
        os.write(report, b"x")
        k += 1
        time.sleep(pause)


def test_sixty_kills(tmp_path):
    """kill -9 at random moments, with the writer inside `append` nearly all of the time."""
    rng = random.Random(5)
    during = 0
    for attempt in range(60):
        path = tmp_path / f"{attempt}.vtkhdf"
        read, write = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                write_forever(path, write, 0.0)
            finally:
                os._exit(1)
        os.close(write)
        os.read(read, 1)  # the first frame is done
        time.sleep(rng.uniform(0, 0.06))
        os.kill(child, signal.SIGKILL)
        assert os.waitpid(child, 0)[1] == signal.SIGKILL
        done = 1
        while piece := os.read(read, 65536):
            done += len(piece)
        os.close(read)
        with open_run(path) as run:
            assert done <= len(run) <= done + 1
            expected = int.from_bytes(path.read_bytes()[28:36], "little")
            during += path.stat().st_size > expected
            for k in range(len(run)):
                assert same(run.frame(k), particles(k, 10 + 37 * k % 3000))
            frames = len(run)
        if attempt % 4 == 0:
            assert len(vtk_frames(path)) == frames
            with RunWriter.resume(path) as writer:
                append(writer, frames, 5)
            assert len(vtk_frames(path)) == frames + 1
        path.unlink()
    assert during > 0  # some kills hit the middle of a frame


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
def test_failing_write_keeps_earlier_frames(tmp_path, monkeypatch, code):
    """The disk fails at every single write of the third frame in turn."""
    fail_at, failures = 0, 0
    while True:
        path = tmp_path / "a.vtkhdf"
        writer = RunWriter(path, "[scene]", {}, overwrite=True, sync=False)
        for k in (0, 1):
            append(writer, k, COUNTS[k])
        monkeypatch.setattr(hdf5, "os", Recorder(fail_at, code))
        try:
            append(writer, 2, COUNTS[2])
        except OutputError as error:
            failures += 1
            assert "frame 2" in str(error) and str(path) in str(error) and "2 earlier frames" in str(error)
            if code == errno.ENOSPC:
                assert "disk is full" in str(error) and "melt resume" in str(error)
            with pytest.raises(OutputError):
                append(writer, 3, COUNTS[3])
        else:
            break
        finally:
            monkeypatch.undo()
            writer.close()
        check(path, 2)
        with RunWriter.resume(path, sync=False) as again:
            append(again, 2, COUNTS[2])
        check(path, 3)
        fail_at += 1 if code == errno.ENOSPC else 17
    assert failures > 3


def test_failure_at_creation_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(hdf5, "os", Recorder(1))
    with pytest.raises(OutputError, match="cannot create.*disk is full"):
        RunWriter(tmp_path / "a.vtkhdf", "[scene]", {})
    assert os.listdir(tmp_path) == []


def test_limit_of_the_file_size(tmp_path):
    """A real refusal by the kernel: ulimit -f."""
    path = tmp_path / "a.vtkhdf"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, hard))
    try:
        with pytest.raises(OutputError, match="ulimit"), RunWriter(path, "[scene]", {}) as writer:
            for k in range(1000):
                frames = k
                writer.append(k, particles(k, 1500), {"kinetic_energy": 1.0})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)
    with open_run(path) as run:
        assert len(run) == frames > 1
        assert same(run.frame(-1), particles(frames - 1, 1500))
