"""Runs that boil: life-cycle, ledgers, repeatability, resumption (boiling V17, V18, V21, V22, V25, V26)."""

import functools

import numpy as np
import pytest

from melt.scene import load_scene
from melt.simulation import Simulation

HOT = ["fluid.temperature=99", "boiling.latent_scale=0.005", "boiling.nucleation_time=0.1"]


def pot(*overrides, preset=None, precision="double"):
    """The small kettle, hotter: it boils within a tenth of a second."""
    return load_scene("kettle_small", [f"solver.precision={precision}", *HOT, *overrides], preset)


def stepped(scene, steps, **options):
    sim = Simulation(scene, "cpu", **options)
    for _ in range(steps):
        sim.step()
    return sim


@functools.lru_cache
def boiled():
    """A run of 0.7 s in which bubbles are born, merge and burst."""
    return stepped(pot(), 170)


def state_of(sim):
    return {n: sim.state.read(n) for n in ("id", "phase", "position", "velocity", "temperature", "bubble_radius", "bubble_volume", "cargo")}


def same(a, b):
    return all(a[n].tobytes() == b[n].tobytes() for n in a)


@pytest.mark.parametrize("overrides", [
    [], ["boiling.vapour.per_burst=2"], ["solver.pressure=sph", "time.n_sub_max=64"], ["solver.pbf.precision=true"],
    ["boiling.heat_model=grid"], ["boiling.boost=viscosity", "boiling.surface_transfer=1"],
])
def test_a_boiling_run_launches_and_allocates_what_the_plan_lists_and_nothing_else(overrides):
    sim = stepped(pot(*overrides, "boiling.bubbles.merge_age=0", "boiling.latent_scale=0"), 140)
    listed = set(sim.prepared.stages) - {"bubble_exclude"}  # of bubbles larger than a spacing
    assert set(sim.do.launches) - {"bubble_exclude"} == listed
    assert set(sim.state.arrays) == set(sim.prepared.fields)


def test_it_boils_and_every_part_of_the_life_cycle_happens():
    s = boiled().series()
    assert s["boiled"] > 20
    assert s["merged"] > 20
    assert s["burst"] > 0
    assert 0 < s["bubbles"] < 4 * s["boiled"]
    assert s["density_error_max"] < 0.08


def test_mass_is_exact_in_quarters_and_heat_to_rounding():
    s = boiled().series()
    assert s["quarters_missing"] == 0
    assert abs(s["heat_missing"]) < 1e-10 * boiled().do.clock.ledger["start_heat"]


def test_liquid_stays_below_the_boiling_point_and_bubbles_stay_in_the_tank():
    sim = boiled()
    assert sim.series()["temperature_max"] <= 100.0
    x, r = sim.read("position"), sim.read("bubble_radius")
    on = sim.read("phase") == 3
    assert (x[on, :2] - r[on, None] >= -1e-12).all()
    assert (x[on, :2] + r[on, None] <= 0.24 + 1e-12).all()
    assert (x[on, 2] >= r[on] - 1e-12).all()


def test_ids_are_never_used_twice():
    sim = boiled()
    alive = sim.read("phase") != 5
    ids = np.sort(sim.state.read("id"))
    assert np.unique(sim.read("id")[alive]).size == alive.sum()
    assert ids[-1] < sim.do.clock.next_id


def test_a_run_repeats_itself_bit_by_bit_and_another_seed_differs():
    first, second, other = (stepped(pot(f"boiling.seed={seed}"), 60) for seed in (1, 1, 2))
    assert same(state_of(first), state_of(second))
    assert not same(state_of(first), state_of(other))


def test_threads_do_not_change_a_bit():
    numba = pytest.importorskip("numba")
    before = numba.get_num_threads()
    if before == 1:
        pytest.skip("one thread only")
    try:
        numba.set_num_threads(1)
        alone = state_of(stepped(pot(), 60))
    finally:
        numba.set_num_threads(before)
    assert same(alone, state_of(stepped(pot(), 60)))


@pytest.mark.parametrize("overrides", [
    ["boiling.vapour.per_burst=2"], ["boiling.mass_model=recycle"], ["solver.pbf.precision=true"],
    ["solver.pressure=sph", "time.n_sub_max=64"],
])
def test_a_run_goes_on_from_a_checkpoint_bit_by_bit(overrides):
    """From several steps: in most of them nothing boils in the step that follows."""
    overrides = [*overrides, "boiling.nucleation_time=0.5"]
    whole = Simulation(pot(*overrides), "cpu")
    for _ in range(70):
        whole.step()
    assert whole.do.clock.bubbles > 0
    quiet = 0
    for _ in range(4):
        arrays, meta = whole.checkpoint()
        again = Simulation(pot(*overrides), "cpu")
        again.restore(arrays, meta)
        boiled = whole.do.clock.ledger["boiled"]
        for sim in (whole, again):
            sim.step()
        quiet += whole.do.clock.ledger["boiled"] == boiled
        assert same(state_of(whole), state_of(again))
        for _ in range(3):
            whole.step()
    assert quiet > 0
    for _ in range(19):
        again.step()
    while whole.do.clock.step < again.do.clock.step:
        whole.step()
    assert same(state_of(whole), state_of(again))
    assert whole.series() == again.series()


@pytest.mark.parametrize("model", ["nucleate", "recycle"])
def test_other_mass_models_keep_their_ledgers(model):
    s = stepped(pot(f"boiling.mass_model={model}"), 120).series()
    assert s["boiled"] > 0
    assert s["quarters_missing"] == 0
    assert abs(s["heat_missing"]) < 1e-9 * s["heat_in"]


def test_more_superheat_boils_more_and_none_boils_nothing():
    """V25. There is no onset superheat in the model, and no film boiling."""
    counts = [stepped(pot(f"boiling.heater.temperature={T}", "fluid.temperature=98"), 120).series()["boiled"] for T in (99, 105, 115, 130)]
    assert counts[0] == 0
    assert 0 < counts[1] < counts[2] < counts[3]


def test_the_literal_rule_boils_cold_water_away():
    """V26: the paper's rule has no price in heat. Its flaw is kept in the preset and shown here (spec's own tank: experiments)."""
    scene = load_scene("kettle_small", ["fluid.temperature=20", "boiling.bubbles.capacity=8000"], "paper")
    sim = stepped(scene, 480)
    s = sim.series()
    assert s["boiled"] > 0.5 * 1152  # measured 66 %, at a mean of 25.1 degC
    assert s["temperature_mean"] < 28


def test_lockstep_through_birth_merging_and_bursting():
    shallow = pot("fluid.fill.0.upper=[0.24,0.24,0.06]", "boiling.bubbles.merge_age=0.02", "boiling.latent_scale=0", precision="single")
    sim = Simulation(shallow, "cpu", lockstep="cuda-emulated")
    for _ in range(50):
        sim.step()
    ledger = sim.do.clock.ledger
    assert ledger["boiled"] > 0 and ledger["merged"] > 0
    assert ledger["burst"] + ledger["vanished"] > 0
    assert max(found.ratio for found in sim.do.worst.values()) <= 1
