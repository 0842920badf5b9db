"""Checkpoints come back bit by bit, and damage is found."""

import math
import os

import numpy as np
import pytest

from melt.output import checkpoint
from melt.output.errors import OutputError, RunFileError

ARRAYS = {
    "position": np.arange(12, dtype=np.float64).reshape(3, 4) / 7,
    "velocity": np.array([[np.nan, -0.0, np.inf, 1e-42]] * 3, np.float32),
    "phase": np.arange(4, dtype=np.int32),
    "empty": np.zeros((0, 27), np.int32),
    "columns": np.asfortranarray(np.arange(6.0).reshape(2, 3)),
}
META = {
    "step": 12345678901,
    "time": 0.1 + 0.2,
    "tiny": math.ulp(1.0),
    "backend": "cpu",
    "list": [1, 2.5, None],
}


def test_comes_back_bit_by_bit(tmp_path):
    path = checkpoint.beside(tmp_path / "a.vtkhdf")
    assert path.name == "a.vtkhdf.ckpt"
    checkpoint.save(path, ARRAYS, META)
    arrays, meta = checkpoint.load(path)
    assert meta == META and list(arrays) == list(ARRAYS)
    for name, array in ARRAYS.items():
        assert arrays[name].dtype == array.dtype and arrays[name].shape == array.shape
        assert arrays[name].tobytes() == array.tobytes() and arrays[name].flags.writeable
    assert os.listdir(tmp_path) == [path.name]


def test_every_flipped_byte_is_found(tmp_path):
    path = tmp_path / "a.ckpt"
    checkpoint.save(path, ARRAYS, META)
    data = path.read_bytes()
    for k in range(0, len(data), 13):
        path.write_bytes(data[:k] + bytes([data[k] ^ 1]) + data[k + 1 :])
        with pytest.raises(RunFileError, match="damaged|no checkpoint"):
            checkpoint.load(path)
    for size in (0, 5, 30, len(data) // 2, len(data) - 1):
        path.write_bytes(data[:size])
        with pytest.raises(RunFileError, match="damaged|no checkpoint"):
            checkpoint.load(path)
    with pytest.raises(RunFileError, match="no such file"):
        checkpoint.load(tmp_path / "missing")


@pytest.mark.parametrize("failing", ["fsync", "replace"])
def test_failure_keeps_the_older_one(tmp_path, monkeypatch, failing):
    path = tmp_path / "a.ckpt"
    checkpoint.save(path, ARRAYS, {"step": 1})

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(checkpoint.os, failing, fail)
    with pytest.raises(OutputError, match="checkpoint.*disk is full"):
        checkpoint.save(path, ARRAYS, {"step": 2})
    monkeypatch.undo()
    assert checkpoint.load(path)[1] == {"step": 1} and os.listdir(tmp_path) == ["a.ckpt"]


def test_interrupt_leaves_no_half_file(tmp_path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(checkpoint.os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        checkpoint.save(tmp_path / "a.ckpt", ARRAYS, META)
    assert os.listdir(tmp_path) == []


def test_refuses_what_it_cannot_keep(tmp_path):
    with pytest.raises(OutputError, match="'names'"):
        checkpoint.save(tmp_path / "a.ckpt", {"names": np.array(["a"])}, {})
