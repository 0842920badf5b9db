"""The error table: what it holds, what it stores, and its exit status."""

import io

import h5py
import numpy as np
import pytest
from rich.console import Console

from melt.check import report


def run(tmp_path, monkeypatch=None, **options):
    text = io.StringIO()
    out = tmp_path / "check.h5"
    console = Console(file=text, width=160)
    status = report.main(
        ["density"],
        ("reference", "cpu", "cuda-emulated"),
        ("single",),
        n=301,
        out=out,
        console=console,
        **options,
    )
    return status, out, text.getvalue()


def test_table_is_stored_with_versions_and_seed(tmp_path):
    status, out, text = run(tmp_path, seed=0)
    assert status == 0 and "density" in text
    with h5py.File(out) as file:
        assert file.attrs["seed"] == 0 and file.attrs["n"] == 301 and file.attrs["red"] == 0
        assert file.attrs["numba"] and file.attrs["numpy"] == np.__version__
        pairs = set(zip(file["backend"].asstr()[:], file["against"].asstr()[:]))
        assert pairs == {("cpu", "reference"), ("cuda-emulated", "reference"), ("cuda-emulated", "cpu")}
        assert np.all(file["ratio"][:] <= 1) and np.any(file["ratio"][:] > 0)


def test_wrong_stage_is_red_and_sets_the_exit_status(tmp_path, monkeypatch):
    import melt.cpu.density

    right = melt.cpu.density.density

    def wrong(*arguments):
        right(*arguments)
        arguments[-1][-1] *= 1.001

    wrong_at_last = wrong
    monkeypatch.setattr(melt.cpu.density, "density", wrong_at_last)
    status, out, text = run(tmp_path)
    assert status == 1 and "RED density" in text


def test_stage_that_cannot_be_imported_is_red_not_skipped(tmp_path, monkeypatch):
    import melt.cuda.density

    monkeypatch.delattr(melt.cuda.density, "density")
    status, out, text = run(tmp_path)
    assert status == 1 and "AttributeError" in text


def test_unknown_stage_is_refused():
    with pytest.raises(ValueError, match="densty"):
        report.main(["densty"])
