"""Run files and checkpoints that are cut short, foreign or damaged, given to each command that reads them."""

import os
import shutil

import h5py
import numpy as np
import pytest
from small_runs import melt, refused

from melt.output.checkpoint import beside


def _foreign(path, **parts):
    with h5py.File(path, "w") as file:
        if "vtk" in parts:
            file.create_group("VTKHDF").attrs.update(Type=np.bytes_(parts["vtk"]), Version=[2, 3])
        if "melt" in parts:
            file.create_group("melt")
        if "scene" in parts:
            file["melt/scene"] = np.bytes_(parts["scene"])
        if "steps" in parts:
            file["VTKHDF/Steps/Values"] = [0.0, 1.0]
            file["VTKHDF/Steps"].attrs["NSteps"] = 2
            file["VTKHDF/Points"] = [1.0]
            file["VTKHDF/NumberOfPoints"] = [1]


def _noise(data):
    data = bytearray(data)
    for k in range(100, len(data), 97):
        data[k] ^= 0xFF
    return bytes(data)


BAD_RUNS = {
    "cut short": (lambda path, data: path.write_bytes(data[: len(data) // 2]), "is cut short"),
    "one byte short": (lambda path, data: path.write_bytes(data[:-1]), "is cut short"),
    "a head": (lambda path, data: path.write_bytes(data[:20]), "is cut short"),
    "empty": (lambda path, data: path.write_bytes(b""), "not an HDF5 file"),
    "text": (lambda path, data: path.write_bytes(b"hello " * 99), "not an HDF5 file"),
    "noise": (lambda path, data: path.write_bytes(_noise(data)), "run file of melt"),
    "a folder": (lambda path, data: path.mkdir(), "this is a folder"),
    "missing": (lambda path, data: None, "there is no such file"),
    "foreign": (lambda path, data: _foreign(path), "no run file of melt"),
    "of VTK": (lambda path, data: _foreign(path, vtk="PolyData"), "no run file of melt"),
    "of VTK, an image": (
        lambda path, data: _foreign(path, vtk="ImageData", melt=1, scene=""),
        "no run file of melt",
    ),
    "hollow": (lambda path, data: _foreign(path, vtk="PolyData", melt=1), "no run file of melt"),
    "half filled": (
        lambda path, data: _foreign(path, vtk="PolyData", melt=1, scene="x", steps=1),
        "tables cannot be read",
    ),
}
READERS = {
    "info": ["info", "RUN"],
    "resume": ["resume", "RUN"],
    "picture": ["render", "RUN", "-o", "a.png"],
    "video": ["render", "RUN", "-o", "a.mp4"],
    "mesh": ["render", "RUN", "-o", "a.ply"],
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("case", BAD_RUNS)
def test_a_file_that_is_no_whole_run_is_refused(case, reader, whole, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    make, said = BAD_RUNS[case]
    path = tmp_path / "run.vtkhdf"
    make(path, whole.read_bytes())
    shutil.copy(beside(whole), beside(path))
    before = path.read_bytes() if path.is_file() else None
    refused(melt(*[w.replace("RUN", "run.vtkhdf") for w in READERS[reader]]), "run.vtkhdf", said)
    assert set(os.listdir()) <= {"run.vtkhdf", "run.vtkhdf.ckpt"}
    assert before == (path.read_bytes() if path.is_file() else None)


CHECKPOINTS = {
    "missing": (None, "there is no such file"),
    "cut short": (lambda data: data[: len(data) // 2], "its checksum is wrong"),
    "empty": (lambda data: b"", "no checkpoint of this version"),
    "text": (lambda data: b"hello" * 99, "no checkpoint of this version"),
    "changed": (lambda data: data[:3000] + b"!" + data[3001:], "its checksum is wrong"),
    "a run file": (lambda data: b"\x89HDF\r\n\x1a\n" + data, "no checkpoint of this version"),
}


@pytest.mark.parametrize("case", CHECKPOINTS)
def test_a_bad_checkpoint_is_refused_and_the_run_file_left_alone(case, whole, tmp_path):
    path = tmp_path / "run.vtkhdf"
    shutil.copy(whole, path)
    change, said = CHECKPOINTS[case]
    if change is not None:
        beside(path).write_bytes(change(beside(whole).read_bytes()))
    refused(melt("resume", path), said, "run.vtkhdf.ckpt")
    assert path.read_bytes() == whole.read_bytes()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--frame", "6"], "6 frames"),
        (["--frame", "-7"], "6 frames"),
        (["--view", "below"], "unknown view 'below'"),
        (["-o", "a.jpg"], "the suffix must be one of"),
        (["-o", "a"], "the suffix must be one of"),
    ],
)
def test_wishes_that_no_picture_fulfils_are_refused(words, said, whole, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(melt("render", whole, *(words if "-o" in words else [*words, "-o", "a.png"])), said)
    assert os.listdir() == []
