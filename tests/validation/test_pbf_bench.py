"""The benchmark of the position based fluid: its small version, its arithmetic, and a peer that is not there."""

import json

import h5py
import pytest

from experiments import _splish
from experiments import boiling_pbf_bench as bench


def test_small_version_says_plainly_that_the_peer_is_absent(tmp_path, monkeypatch):
    monkeypatch.setenv("SPLISH_PYTHON", str(tmp_path / "nobody"))
    said = []
    bench.run(tmp_path / "a.h5", quick=True, say=said.append)
    rows = bench.report(tmp_path / "a.h5")
    assert [row.name for row in rows] == ["1,000 liquid, support 2.0, melt", "SPlisHSPlasH"]
    assert rows[1].measured == "absent" and "No such file" in rows[1].note
    assert any("SPlisHSPlasH is absent" in line for line in said)
    with h5py.File(tmp_path / "a.h5") as file:
        many, few = (file[f"melt 010 2.0 {J:02d}"].attrs for J in bench.ITERATIONS)
        assert many["liquid"] == 1000 and many["n_sub"] == 1 and many["precision"] == "single"
        assert 20 < many["neighbours"] < 33  # 26 in the lattice, walls fill up what the rim lacks
        assert many["step_ms"] > few["step_ms"] > 0


def test_peer_is_read_from_its_last_words(tmp_path, monkeypatch):
    """The figures stand behind RESULT, whatever else is printed; a process that dies without them is absent."""
    figures = {"step_ms": 3.5, "liquid": 8}
    for name, body in (("good", f"echo talk; echo 'RESULT {json.dumps(figures)}'; exit 3"), ("bad", "echo lost >&2; kill -SEGV $$")):
        (tmp_path / name).write_text(f"#!/bin/sh\n{body}\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("SPLISH_PYTHON", str(tmp_path / "good"))
    assert bench.ask_peer(2, bench.SPACING, bench.DT, 4, 1, 1, 1) == figures
    monkeypatch.setenv("SPLISH_PYTHON", str(tmp_path / "bad"))
    assert bench.ask_peer(2, bench.SPACING, bench.DT, 4, 1, 1, 1) == {"absent": "lost (exit -11)"}


def test_costs_per_iteration_and_ratios(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs.update(quick=False, threads=2, peer_missing="")
        for who, many, few in (("melt", 24.0, 8.0), ("peer", 100.0, 20.0)):
            for J, ms in ((10, many), (2, few)):
                found = dict(step_ms=ms, liquid=1000, particles=3000, wall=500, neighbours=25.0)
                bench._keep(file, who, 10, 2.0, J, found, lambda text: None)
    melt, peer, ratio = bench.report(tmp_path / "a.h5")
    assert melt.measured == "24.00 ms per step of 10 iterations, 8.00 of 2; 2.000 ms per iteration"
    assert "80.00 ns per pair and iteration, 2,000 wall particles, 2 thread(s)" in melt.note
    assert "10.000 ms per iteration" in peer.measured and "500 wall" in peer.note
    assert ratio.measured == "4.2 per step of 10 iterations, 2.5 of 2" and ratio.note == "5.0 per iteration"


def test_both_simulate_the_same_column():
    scene, theirs = bench.dam_break(12, 2.5, 10), _splish.scene(12, bench.SPACING, bench.DT, "pbf")
    block = theirs["FluidBlocks"][0]
    # their blocks leave out a particle at each end
    low, high = block["start"][0] + bench.SPACING, block["end"][0] - bench.SPACING
    assert round((high - low) / bench.SPACING) + 1 == 12 and low == pytest.approx(bench.SPACING / 2)
    assert scene.fluid.fill[0].upper[0] == pytest.approx(high + bench.SPACING / 2)
    assert scene.solver.support == 2.5 and scene.solver.pbf.iterations == 10
    wall, size = theirs["RigidBodies"][0], scene.domain.upper
    clear = [s - 2 * 0.7 * bench.SPACING for s in wall["scale"]]
    assert clear == pytest.approx(list(size)) and theirs["Configuration"]["simulationMethod"] == 2
