"""The benchmark of incompressible liquids: both codes simulate one dam break, the report reads only the file."""

import h5py
import pytest

from experiments import _splish, slime_bench
from melt import bench_slime


@pytest.mark.parametrize("method, mu", [("dfsph", 0.0), ("weiler", 50.0)])
def test_both_simulate_the_same_dam_break(method, mu):
    scene, theirs = bench_slime.dam(12**3, mu), _splish.scene(12, bench_slime.SPACING, bench_slime.DT, method)
    wall, size = theirs["RigidBodies"][0], scene.domain.upper
    assert [s - 2 * 0.7 * bench_slime.SPACING for s in wall["scale"]] == pytest.approx(list(size))
    solver, liquid = theirs["Configuration"]["DFSPH"], theirs["Materials"][0]
    assert solver["maxError"] == pytest.approx(100 * scene.solver.dfsph.density_tolerance)  # theirs is in percent
    assert solver["maxErrorV"] == pytest.approx(100 * scene.solver.dfsph.divergence_tolerance)
    if mu:
        weiler = liquid["Weiler et al. 2018"]
        assert weiler["viscosity"] * liquid["density0"] == pytest.approx(scene.viscosity.mu)  # theirs is kinematic
        assert weiler["viscoMaxError"] == scene.viscosity.tolerance


def test_report_without_the_peer(tmp_path, monkeypatch):
    monkeypatch.setenv("SPLISH_PYTHON", str(tmp_path / "no_python"))
    monkeypatch.setattr(bench_slime, "PARTS", bench_slime.PARTS[:2])
    slime_bench.run(tmp_path / "a.h5", quick=True, say=lambda line: None)
    rows = {row.name: row for row in slime_bench.report(tmp_path / "a.h5")}
    assert rows["SPlisHSPlasH"].measured == "absent"
    assert {"1,000 liquid, 0 Pa s, melt", "1,000 liquid, 50 Pa s, melt", "part: viscosity, split"} <= set(rows)


def test_targets_are_rows_that_can_miss(tmp_path):
    figures = dict.fromkeys(slime_bench.KEPT, 1.0) | {"liquid": 59_319, "wall": 8, "step_ms_best": 50.0}
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs.update(threads=2, peer_missing="")
        for mu, ms in ((0.0, 59.0), (50.0, 96.0)):
            slime_bench._keep(file, "melt", 39, mu, figures | {"step_ms": ms}, lambda line: None)
    assert [row.ok for row in slime_bench.report(tmp_path / "a.h5")] == [True, False]
