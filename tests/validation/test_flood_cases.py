"""Small versions of `experiments.flood_analytic`. Bounds at twice the spacing of the specification are 2^0.7 times its own."""

import h5py
import pytest

from experiments import _flood_cases as cases
from experiments import _flood_steady as flows
from experiments import _flood_still as still
from experiments import flood_analytic

COARSE = 2**0.7  # r0 = 0.2 m in place of 0.1 m, with the least order that is asked for


@pytest.mark.parametrize("name", ["ritter", "stoker"])
def test_dam_breaks(name):
    found = cases.dam(name, 0.2)
    assert found["L1"] <= 0.015 * COARSE and found["L1_velocity"] <= 0.05 * COARSE
    assert found["volume_error"] <= 1e-12
    if name == "stoker":
        assert abs(found["shock"]) <= 1.5


def test_measures_tell_a_wrong_solution():
    """A dam that stays, as that of the linear gas law, is far off; so is a lattice, whose rows decouple (isotropy trap)."""
    right, linear, lattice = (cases.dam("ritter", 0.2, *s) for s in ((), ("solver.form=linear",), ("fluid.layout=lattice",)))
    assert linear["L1"] > 0.1 and linear["front"] < 5 < right["front"]
    assert lattice["L1"] > 1.3 * right["L1"]  # 1.46 times; 1.83 times at half the spacing


def test_supports_must_be_free_to_grow():
    errors = [cases.dam("ritter", 0.2, f"solver.support_limits=[0.25, {k}]")["L1"] for k in (1.5, 2.0, 5.0)]
    assert errors[0] > errors[1] > errors[2]


def test_stabilisation_is_needed_and_its_size_matters_little():
    without, usual, twice = (cases.dam("stoker", 0.2, f"solver.alpha={a}", "time.n_sub_max=400") for a in (0.0, 1.0, 2.0))
    assert without["L1"] > 2 * usual["L1"]
    assert twice["L1"] == pytest.approx(usual["L1"], rel=0.3)


@pytest.mark.parametrize("kind", ["planar", "channel"])
def test_bowls_keep_period_and_amplitude(kind):
    found = cases.bowl(kind, 0.05, 1)
    assert found["L1"] <= 0.02 and abs(found["period"]) <= 0.002 and abs(found["amplitude"]) <= 0.005


def test_a_pulsating_bowl_keeps_its_period():
    """Its depth misses the 2 %: Lax-Friedrichs damps what is compressed."""
    found = cases.bowl("radial", 0.05, 1)
    assert abs(found["period"]) <= 0.005 and found["L1"] <= 0.06


@pytest.mark.parametrize("bed", ["smooth bump", "kinked bump"])
def test_balanced_form_rests_exactly(bed):
    found = still.exact_lake(bed, 0.2, 10)
    assert found["clamped"] == found["columns"] and found["least_volume"] > 0.3
    assert found["surface"] <= 1e-12 and found["speed"] <= 1e-12


def test_a_lake_comes_to_rest():
    found = still.lake("kinked bump", 0.2, 200.0)
    assert found["surface_rms"] <= 0.005
    assert found["speed"] <= 2e-4  # after 2 s; twice the specification's, at twice the spacing


def test_steady_flow_over_a_bump_between_driven_edges():
    found = flows.steady("subcritical", "fluid.spacing=0.2", end=15.0)
    assert found["mean_L1"] <= 0.02 and abs(found["q"]) <= 0.02 and found["volume_error"] <= 1e-12


def test_a_wave_leaves_over_a_side_that_is_far_and_comes_back_from_a_given_depth():
    """At r0 = 0.2 m the wave's front is 10 columns long: 10 % in place of the 5 % of finer ones."""
    assert flows.leaving_wave()["reflected"] <= 0.1
    edge = "edge=[{side = 'east', depth = 1.0}]"
    assert flows.leaving_wave(edge)["reflected"] > 0.4


def test_a_circle_stays_round():
    found = cases.circle(0.2)
    assert found["ring"] <= 0.02 * COARSE and found["grid_L1"] < 0.1


def test_quick_experiment_claims_nothing_and_its_rows_can_fail(tmp_path):
    flood_analytic.run(tmp_path / "a.h5", quick=True, say=lambda text: None)
    rows = flood_analytic.report(tmp_path / "a.h5")
    assert len(rows) > 60 and all(row.ok is None and row.bound == "" for row in rows)
    assert not [row for row in rows if "Error" in row.measured]
    with h5py.File(tmp_path / "a.h5", "a") as file:
        file.attrs["quick"] = False
        for group in file["bowl"].values():
            for run in group.values():
                run.attrs["period"] = 0.5
    judged = {row.name: row.ok for row in flood_analytic.report(tmp_path / "a.h5")}
    assert not judged["bowl, planar, alpha 1: period off by"] and {None, True, False} <= set(judged.values())
