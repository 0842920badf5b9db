"""Small versions of the measured floods (`experiments.flood_measured`), and their rows."""

from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from experiments import _flood_data as data
from experiments import _flood_measured as cases
from experiments import _flood_norms as norms
from experiments import flood_measured, flood_table2
from melt.physics.phases import INACTIVE, LIQUID


def test_a_dam_break_comes_over_the_sill_as_measured():
    """All 40 s at 0.1 m: arrivals within 0.6 s, RMSE within the pass criteria."""
    sill = data.shipped_sill()
    sim, facts, readings = cases.ran("triangular_sill", ["fluid.spacing=0.1"])
    assert abs(facts["volume_error"]) < 1e-12 and facts["columns"] == facts["columns_end"] > 900
    for k, (name, bound) in enumerate({"G4": 0.10, "G10": 0.10, "G13": 0.04, "G20": 0.05}.items()):
        (t_m, y_m), (t, y) = sill.gauges[name], (readings["time"], readings["depth"][:, k])
        assert norms.rmse(t_m, y_m, t, y) < bound, name
        level = 0.17 if name == "G20" else 0.02
        assert norms.arrival(t, y, level) == pytest.approx(norms.arrival(t_m, y_m, level), abs=0.6), name


def test_a_solitary_wave_runs_up_a_beach():
    """Coarse. The flume has 0.078 to 0.085; Wendland C2 runs too high here as at full size (0.096, a published miss), the cubic
    spline, whose columns pair up, comes to 0.079. Held is what this size gives, so that a change shows."""
    shore = cases.Shore(1e-3)
    sim, facts, _ = cases.ran("solitary_beach", cases.COARSE_BEACH, watch=shore)
    rows = np.array(shore.series)
    assert shore.top == pytest.approx(0.092, abs=0.008)
    assert rows[rows[:, 1].argmax(), 0] == pytest.approx(18.2, abs=1.5)  # t sqrt(g/d) = 57
    assert abs(facts["volume_error"]) < 1e-12


def test_still_water_beside_a_driven_edge_stays_still_on_a_rising_bed():
    """The stage is compared, not the depth: 3 mm/s, against 200 mm/s where depths were."""
    if data.monai() is None:
        pytest.skip("the measured case is not there: set MELT_DATA to the folder that holds it")
    sim, _, _ = cases.ran("monai", ["fluid.spacing=0.06", "time.end=0.2"])
    assert abs(sim.do.clock.sources["edge west"]["speed"]) < 0.02


def test_shore_takes_the_highest_thick_column():
    """Four columns around an island: one too thin, one that is no water any more, one in front, one far away."""
    x = np.array([[1.0, 0, 0], [-1, 0, 0], [-1.1, 0, 0], [9, 0, 0]])
    values = {
        "phase": np.array([LIQUID, LIQUID, INACTIVE, LIQUID]), "depth": np.array([1e-4, 0.1, 0.1, 0.1]), "position": x,
        "bed": np.array([0.5, 0.3, 0.9, 0.4]),
    }  # fmt: skip
    terrain = SimpleNamespace(world=lambda x: x + 10, datum=-0.2)
    sim = SimpleNamespace(read=values.__getitem__, time=1.0, initial=SimpleNamespace(terrain=terrain))
    shore = cases.Shore(1e-3, centre=(10, 10), places=[(9.0, 10.0), (0, 0)])
    shore(sim)
    assert shore.series == [(1.0, pytest.approx(0.2))] and shore.top == pytest.approx(0.2)  # the one far away
    assert shore.around[8] == pytest.approx(0.1) and np.isinf(np.delete(shore.around, 8)).all()
    assert shore.near[0] == pytest.approx(0.1) and np.isinf(shore.near[1])


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    path = tmp_path_factory.mktemp("measured") / "flood-measured.h5"
    only = ["sill", "beach", "monai", "island_B", "merewether"]
    flood_measured.run(path, quick=True, say=lambda text: None, only=only)
    return path


def test_quick_experiment_runs_and_claims_nothing(quick):
    rows = flood_measured.report(quick)
    assert sum(row.name.startswith("triangular sill") for row in rows) == 12
    assert all(row.ok is None and row.bound == "" for row in rows)


def test_table_2_has_the_papers_figures_and_can_miss(quick, tmp_path):
    mae, rmse, bias, relative, largest = flood_table2._summary(*np.array(list(flood_table2.PAPER.values())).T)
    assert [mae, rmse, bias, largest] == pytest.approx([0.1075, 0.1137, -0.0325, 0.0979], abs=1e-4)
    (quick.parent / "t.h5").unlink(missing_ok=True)
    flood_table2.run(quick.parent / "t.h5", quick=True, say=lambda text: None)
    with h5py.File(quick.parent / "t.h5", "a") as file:  # judged, figures of so short runs do not hold
        file.attrs["quick"] = False
        found = flood_table2.depths(file)["sill"]
    rows = flood_table2.report(quick.parent / "t.h5")
    assert found[0] == ("G10", "G13", "G20", "G4") and np.isfinite(found[1]).all()
    assert any(row.ok is False for row in rows)
