"""Loaders of measured floods; those that need files which are not shipped skip without them."""

import numpy as np
import pytest

from experiments import _flood_data as data
from experiments import _flood_exact as exact
from experiments import _flood_norms as norms


def case(load, *what):
    found = load(*what)
    if found is None:
        pytest.skip("the measured case is not there: set MELT_DATA to the folder that holds it")
    return found


def test_loaders_say_none_where_the_case_is_absent(tmp_path, monkeypatch):
    monkeypatch.setenv("MELT_DATA", str(tmp_path))
    for load in (data.triangular_sill, data.monai, lambda: data.conical_island("A"), data.solitary_beach, data.merewether):
        assert load() is None


def test_shipped_sill():
    sill = data.shipped_sill()
    assert list(sill.gauges) == ["G4", "G10", "G13", "G20"]
    for (name, (t, d)), top, at in zip(sill.gauges.items(), (0.49, 0.58, 0.15, 0.53), (14.9, 11.9, 12.7, 10.9)):
        assert len(t) <= 60 and (np.diff(t) >= 0).all() and 0 < t[0] and t[-1] < 40, name
        assert norms.peak(t, d) == pytest.approx((top, at), abs=0.15), name
    assert sill.bed([25.5, 27, 28.5, 31.5]).tolist() == pytest.approx([0, 0.2, 0.4, 0])
    assert sill.start([0, 20, 29, 31, 35]).tolist() == pytest.approx([0.75, 0, 0, 0.15 - 0.2 / 3, 0.15])


def test_shipped_peaks_are_those_of_the_loader():
    rows = np.loadtxt(data.MEASURED / "conical_island_peaks.csv", delimiter=",", skiprows=1, dtype=str)
    for name, _, *peaks in rows:
        assert [float(p) for p in peaks] == list(data.ConicalIsland.peaks[name].values())


def test_triangular_sill():
    whole, thin = case(data.triangular_sill), data.shipped_sill()
    for name, (t, d) in thin.gauges.items():
        all_of = set(zip(*whole.gauges[name]))
        assert set(zip(t, d)) <= all_of and len(all_of) >= 55, name


def test_monai():
    monai = case(data.monai)
    assert monai.bed.shape == (244, 393) and monai.x[-1] == pytest.approx(5.488) and monai.y[-1] == pytest.approx(3.402)
    assert monai.incident.t[-1] == pytest.approx(22.5)
    for name, top in (("g5", (0.0369, 18.35)), ("g7", (0.0390, 17.0)), ("g9", (0.0454, 16.85))):
        assert norms.peak(*monai.gauges.of(name), 0, 25) == pytest.approx(top, abs=1e-4)
    assert monai.runup.shape == (3, 6) and 0.08 <= monai.runup[0].min() and monai.runup[0].max() <= 0.1


@pytest.mark.parametrize("name", "ABC")
def test_conical_island(name):
    island = case(data.conical_island, name)
    for gauge in ("g6", "g9", "g16", "g22"):
        assert norms.peak(*island.gauges.of(gauge))[0] == pytest.approx(island.peaks[name][gauge], abs=1e-4)
    assert island.runup[:, 1].max() == pytest.approx(island.peaks[name]["runup"], abs=1e-3)
    assert island.runup.shape == (24, 2) and island.runup_liu.shape == (9, 2)
    x, y = island.centre
    assert island.bed(x, y) == pytest.approx(0.305) and island.bed(x + 3.6, y) == pytest.approx(-0.32) == island.bed(x - 9, y)
    assert island.bed(*np.array(island.place["g22"])) == pytest.approx(-0.32 + 0.25)


def test_solitary_beach():
    """The laws of the run-up on all 77 runs: mean deviation 7 %."""
    beach = case(data.solitary_beach)
    H, R, d = beach.runup.T
    assert len(H) == 77 and 0.05 < d.min() and d.max() < 0.4
    off = norms.relative_error(exact.plane_beach_runup(H), R)
    assert off.mean() < 0.08
    assert len(beach.profiles) == 9 and beach.profiles[0.3, 15.0].shape[1] == 2
    assert beach.bed([-1, 19.85, 30]).tolist() == pytest.approx([1 / 19.85, -1, -1])


def test_merewether():
    place = case(data.merewether)
    assert place.bed.shape == (416, 321) == (len(place.y), len(place.x)) and np.isnan(place.bed).sum() == 73
    assert np.nanmin(place.bed) == pytest.approx(16.5, abs=0.1) and len(place.houses) == 60 and set(place.marks) == {44, 43, 31, 32, 42}
    assert all(h.shape[1] == 2 and len(h) > 2 for h in place.houses)
    stages = {name: mark[2] for name, mark in place.marks.items()}
    for i, truth in enumerate(place.published["mae tuflow"]):
        assert np.mean([abs(place.tuflow[n][i] - stages[n]) for n in stages]) == pytest.approx(truth, abs=6e-4)
    assert np.mean([abs(place.published["fv"][n] - stages[n]) for n in stages]) == pytest.approx(place.published["mae fv"], abs=5e-3)
