"""``melt run --on-unstable``, and ``melt check --capsule``: exit codes, and files that are no capsules."""

import re

import h5py
import numpy as np
import pytest
from small_runs import SCENE, alarmed, melt, refused

from melt.cli import DIFFERENT
from melt.cpu import motion
from melt.output.whole import write_whole
from melt.watch import capsule


@pytest.fixture(scope="module")
def fast(tmp_path_factory):
    """The capsule of a run that was stopped for its speed, and what it said."""
    folder = tmp_path_factory.mktemp("fast")
    (folder / "drop.toml").write_text(SCENE)
    result = melt("run", folder / "drop.toml", "-o", folder / "run.vtkhdf", "-b", "cpu", "-q", "--set", "watch.speed=0.05 m/s")
    return folder / "run.vtkhdf.capsule.h5", result


def check(path):
    return melt("check", "--capsule", path, "-b", "reference", "-b", "cpu")


def test_a_stopped_run_names_its_capsule_and_info_does(fast):
    path, result = fast
    said = ("beyond the alarm of 0.05 m/s (watch.speed)", "Fastest is particle", "governs", "frames before are kept")
    what, where, _, remedy, _ = alarmed(result, *said, f"melt check --capsule {path}")
    assert what.startswith("step 2, t = 0.01 s: the largest speed is 0.0")
    assert re.search(r"Stage kick \(call 1 of step 2, from t = 0.005 s\) is the first to write .* of particle \d+", where)
    assert "or watch.speed." in remedy and "--on-unstable halve" in remedy
    assert path.name in melt("info", path.with_name("run.vtkhdf")).output


def test_backends_that_agree_are_no_difference(fast):
    result = check(fast[0])
    assert result.exit_code == 0, result.output
    assert "bad on all of reference, cpu: look at the inputs and the equation" in result.output


def test_a_backend_that_differs_is(fast, monkeypatch):
    def still(phase, mass, force, dt, velocity):
        velocity[:] = 0

    monkeypatch.setattr(motion, "kick", still)
    result = check(fast[0])
    assert result.exit_code == DIFFERENT, result.output
    assert "bad on reference, good on cpu" in result.output


def test_the_simulator_too_where_it_can(fast):
    from melt._compile import CUDA_MISSING

    result = melt("check", "--capsule", fast[0], "-b", "reference", "-b", "cuda-simulated")
    assert result.exit_code == 0, result.output
    assert ("left out" if CUDA_MISSING else "bad on all of reference, cuda-simulated") in result.output


def _flip(path, data):
    with h5py.File(path, "r+") as file:
        file["arrays/velocity"][...] = 0.0


def _foreign(path, data):
    with h5py.File(path, "w") as file:
        file["arrays"] = np.zeros(3)


def _other(path, data):
    with h5py.File(path, "r+") as file:
        file.attrs["arguments"] = "phase mass"


BAD = {
    "missing": (lambda path, data: path.unlink(), "there is no such file"),
    "text": (lambda path, data: path.write_bytes(b"hello " * 99), "cannot be read as a capsule"),
    "cut short": (lambda path, data: path.write_bytes(data[: len(data) // 2]), "cannot be read as a capsule"),
    "foreign": (_foreign, "is no capsule of melt"),
    "changed": (_flip, "its checksum is wrong"),
    "of another version": (_other, "is not the one of this version"),
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_capsules_are_refused_in_words(kind, fast, tmp_path):
    spoil, said = BAD[kind]
    path, data = tmp_path / "bad.h5", fast[0].read_bytes()
    write_whole(path, data)
    spoil(path, data)
    refused(check(path), said)


def test_a_capsule_goes_alone(fast):
    refused(melt("check", "kick", "--capsule", fast[0]), "--capsule has its own stage")
    refused(melt("run", "dam_break_small", "--on-unstable", "pray"), "use stop or halve")


def test_the_module_knows_where_it_writes(fast):
    assert fast[0] == capsule.beside(fast[0].with_name("run.vtkhdf"))
