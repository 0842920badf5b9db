"""The stability atlas: the search finds the boundary, alarms grade, a small map is measured, a killed sweep goes on."""

from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from melt.atlas import store, sweep
from melt.atlas.alarms import FAILED, NOISY, REFUSED, STABLE, Alarm, fall_of
from melt.atlas.maps import Axis, Map, chosen, spread
from melt.atlas.rows import rows_of
from melt.atlas.search import factor_of, islands, reach, search
from melt.errors import MeltError
from melt.geometry.build import build
from melt.plan import prepare
from melt.preflight import limits
from melt.scene import load_scene
from melt.simulation import Simulation

TINY = """
[scene]
name = "tiny"
[time]
end = 0.05
[domain]
upper = [0.8, 0.8, 1.2]
[[fluid.fill]]
lower = [0, 0, 0]
upper = [0.8, 0.8, 0.8]
"""


def grades(last_stable, last_whole):
    """Return a grade function of places with these boundaries, and the list of its calls."""
    calls = []

    def grade(k):
        calls.append(k)
        return STABLE if k <= last_stable else NOISY if k <= last_whole else FAILED

    return grade, calls


@pytest.mark.parametrize("stable", range(-15, 33, 3))
@pytest.mark.parametrize("noisy", [0, 1, 7])
def test_search_finds_both_boundaries_in_few_runs(stable, noisy):
    whole = min(stable + noisy, 32)
    grade, calls = grades(stable, whole)
    known, found, reached = search(grade, farthest=8, nearest=4)
    assert (found, reached) == (stable, whole)
    assert len(calls) == len(set(calls)) <= 14 and set(known) == set(calls)


def test_search_says_where_it_found_nothing():
    assert search(grades(-99, -99)[0], 8, 4)[1:] == (None, None)
    assert search(grades(99, 99)[0], 8, 4)[1:] == (32, 32)
    assert factor_of(32) == 256
    again = {-4: FAILED, 0: STABLE, 4: FAILED, 8: STABLE}
    assert reach(again, lambda grade: grade == STABLE) == 0 and islands(again, 0) == 1


def tank(gains):
    """Return a simulation of nothing, 1 kg that falls 1 m, whose energy [J] follows ``gains``."""
    energies = iter(gains)
    series = {"kinetic_energy": 0.0, "potential_energy": 0.0}
    fields = {"phase": np.zeros(1, int), "position": np.zeros((1, 3)), "mass": np.ones(1)}
    domain = SimpleNamespace(gravity=[0, 0, -9.81])
    return SimpleNamespace(
        series=lambda: series, read=fields.get, gain=lambda: series.update(kinetic_energy=next(energies)),
        initial=SimpleNamespace(top_speed=0.0, nozzles=()),
        prepared=SimpleNamespace(need=SimpleNamespace(incompressible=False), settings=None),
        scene=SimpleNamespace(kind="liquid", spacing=1.0, domain=domain),
    )


def graded(gains, steps=24):
    """Return the verdict on a run whose kinetic energy follows ``gains``; None ends it by an error."""
    def drive(sim, factor):
        sim.gain()
        if sim.series()["kinetic_energy"] is None:
            raise MeltError("burst")
        return 0.1, "sound"

    def figure(sim, series, fall):
        return series["kinetic_energy"] / fall.energy

    m = Map("m", None, drive, (Alarm("energy", figure, 0.01, 10.0),), [], 0.0, "")
    return sweep.graded(tank(gains), m, 1.0, steps)


def test_runs_are_graded_by_what_happens():
    quiet = graded([0.04] * 24)
    assert (quiet["grade"], len(quiet["times"]), quiet["bound"]) == (STABLE, 24, "sound")
    assert quiet["worst"] == pytest.approx(0.04 / (0.25 * 2 * 9.81) / 0.01)
    loud = graded([0.04] * 11 + [0.06] * 3 + [0.0] * 10)
    assert (loud["grade"], loud["step"], len(loud["times"])) == (NOISY, 12, 24)
    assert loud["reason"] == "energy 0.0122, limit 0.01"
    assert graded([0.0, 0.0, None]) | {"times": 0} == dict(
        grade=FAILED, reason="burst", step=3, bound="sound", worst=np.inf, times=0
    )
    burst = graded([float("nan")] * 24)
    assert (burst["grade"], burst["step"]) == (FAILED, 2)


def test_small_map_is_measured_beside_the_bound_of_the_plan(tmp_path):
    path, out = tmp_path / "tiny.toml", tmp_path / "tiny.h5"
    path.write_text(TINY)
    found = sweep.run(path, out, ["dt-stiffness"], rows=2, steps=16, say=lambda text: None)["dt-stiffness"]
    attrs, maps = store.read(out)
    about, cells = maps["dt-stiffness"]
    assert cells == found and attrs["scene"] == "tiny" and (tmp_path / "tiny.png").stat().st_size > 10_000
    low, high = rows_of(cells, about)
    assert high.value == pytest.approx(16 * low.value, rel=0.01)
    for row in (low, high):
        scene = load_scene(path, [f"fluid.sound_speed={row.value}", "time.n_sub=1"])
        assert row.bound == pytest.approx(min(limits(prepare(scene, build(scene))).values()))
        assert 1 <= row.stable <= 16 and row.first.grade in (NOISY, FAILED)
    refused = sweep.measure(path, Map("m", Axis("", "", lambda v: [f"domain.spacing={v}"]), None, (), [], 0.0, ""), 0, 0, -1.0, 10)
    assert refused.grade == REFUSED and "spacing" in refused.reason


def test_rows_that_are_refused_are_drawn(tmp_path, monkeypatch):
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    refused = Map("m", Axis("spacing", "m", lambda v: [f"domain.spacing={-v!r}"], spread(1, 2)), None, (), [], 0.0, "none", octaves=1)
    monkeypatch.setattr(sweep, "chosen", lambda scene, names: [refused])
    said = []
    cells = sweep.run(path, tmp_path / "a.h5", rows=2, say=said.append)["m"]
    assert {c.grade for c in cells} == {REFUSED} and (tmp_path / "a.png").exists()
    assert "never stable; then refused: " in said[1] and "spacing" in said[1]


@pytest.fixture
def faked(tmp_path, monkeypatch):
    """A scene file and the list of runs that were made of it; the third and later ones may be cut off."""
    path, runs = tmp_path / "tiny.toml", []
    path.write_text(TINY)

    def measure(name, m, row, k, value, steps, overrides):
        if len(runs) == runs_at_most[0]:
            raise KeyboardInterrupt
        runs.append((row, k))
        return store.Cell(row, k, value, factor_of(k), STABLE if k <= 3 + row else FAILED, "" if k <= 3 else "burst", 1, 9, "sound", 0.5)

    runs_at_most = [-1]
    monkeypatch.setattr(sweep, "measure", measure)
    return SimpleNamespace(path=path, runs=runs, at_most=runs_at_most)


def test_killed_sweep_keeps_its_runs_and_goes_on(faked, tmp_path):
    def swept(out):
        return sweep.run(faked.path, out, ["dt-stiffness"], rows=3, say=said.append, picture=False)["dt-stiffness"]

    said, whole, cut = [], tmp_path / "whole.h5", tmp_path / "cut.h5"
    expected, runs = swept(whole), faked.runs[:]
    faked.runs.clear()
    faked.at_most[0] = 5
    with pytest.raises(KeyboardInterrupt):
        swept(cut)
    assert not cut.exists() and len(store.read(tmp_path / "cut.h5.part")[1]["dt-stiffness"][1]) == 5
    assert "5 runs are kept" in said[-1]
    faked.at_most[0] = -1
    assert swept(cut) == expected and faked.runs == runs  # each run once
    assert store.read(cut)[1]["dt-stiffness"][1] == expected
    assert sorted(p.name for p in tmp_path.glob("*h5*")) == ["cut.h5", "whole.h5"]


def test_speeds_are_judged_by_bodies_that_move():
    """Nothing else drives this liquid: by a fall of no height all of its runs would fail."""
    fall = fall_of(Simulation(load_scene("couette"), "cpu"))
    assert fall.speed == 0.1 and fall.time == pytest.approx(2 * fall.length / 0.1)


def test_runs_of_other_maps_stay_when_one_is_finished(faked, tmp_path):
    def swept(*maps):
        return sweep.run(faked.path, out, maps, rows=3, say=said.append, picture=False, overwrite=True)

    said, out = [], tmp_path / "a.h5"
    faked.at_most[0] = 5
    with pytest.raises(KeyboardInterrupt):
        swept("dt-viscosity")
    faked.at_most[0] = -1
    swept("dt-stiffness")
    assert "5 runs are kept" in said[-1] and list(store.read(out)[1]) == ["dt-stiffness"]
    assert len(store.read(tmp_path / "a.h5.part")[1]["dt-viscosity"][1]) == 5
    swept("dt-viscosity")
    assert list(store.read(out)[1]) == ["dt-viscosity"] and not (tmp_path / "a.h5.part").exists()


def test_a_part_of_something_else_is_not_taken_for_a_sweep(faked, tmp_path):
    with h5py.File(tmp_path / "a.h5.part", "w"):
        pass
    with pytest.raises(MeltError, match="left from a sweep of another scene"):
        sweep.run(faked.path, tmp_path / "a.h5", ["dt-stiffness"], say=print)


def test_scenes_have_the_maps_of_their_system():
    assert [m.name for m in chosen(load_scene("kettle_small"), ())] == ["dt-iterations", "dt-diffusivity"]
    assert [m.name for m in chosen(load_scene("kettle_ice"), ())] == ["dt-iterations"]  # [heat] conducts there
    assert [m.name for m in chosen(load_scene("stoker"), ())] == ["dt-alpha", "dt-depth-ratio"]
    assert [m.name for m in chosen(load_scene("slime_drop"), ())] == ["dt-viscosity", "dt-tension", "dt-elastic"]
    with pytest.raises(MeltError, match="none for solids in incompressible liquids"):
        chosen(load_scene("ice_dfsph"), ())
    assert spread(0.1, 10)(3) == [0.1, 1.0, 10.0]
