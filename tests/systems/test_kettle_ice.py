"""Ice in a kettle: what combines, what is kept, what is refused (boiling 2.1, 3; melting 2.7, 3.1; ADR 20)."""

import functools

import numpy as np
import pytest
from boiling_scenes import pot
from scene_runs import stepped

from melt.errors import SceneError
from melt.geometry.build import build
from melt.physics.phases import LIQUID, SOLID
from melt.plan import prepare
from melt.scene import load_scene, scene_from_dict
from melt.simulation import Simulation

#: A smaller kettle, in which the ice melts within a tenth of a second, and the water boils within another.
QUICK = ["domain.upper=[0.16,0.16,0.24]", "fluid.fill.0.upper=[0.16,0.16,0.1]", "solid.0.position=[0.08,0.08,0.06]",
         "solid.0.size=[0.08,0.08,0.04]", "fluid.temperature=97", "heat.conductivity_scale=40000", "boiling.heater.half_size=[0.08,0.08]",
         "boiling.heater.rate=none", "boiling.heater.temperature=200", "boiling.latent_scale=0.002", "boiling.nucleation_time=0.05"]
STATE = ("id", "phase", "position", "velocity", "temperature", "latent_energy", "latent_store", "bubble_radius")


def kettle(*overrides):
    return load_scene("kettle_ice", [*QUICK, *overrides])


def state(sim):
    return b"".join(sim.read(n).tobytes() for n in STATE)


@functools.lru_cache
def boiled():
    """A run in which all of the ice melts and some of its melt boils."""
    return stepped(kettle(), 80)


def test_ice_melts_water_boils_and_no_mass_or_heat_is_missing():
    s = boiled().series()
    assert s["melted_fraction"] == 1 and s["boiled"] > 20
    assert abs(s["heat_missing"]) < 1e-12 * s["heat_in"]
    assert abs(s["mass_created"]) < 1e-12 * s["mass"]
    assert s["quarters_missing"] == 0 and s["lost_particles"] == 0
    assert "density" not in boiled().frame() and "latent_energy" in boiled().frame()
    assert s["boiled_heat"] > s["boiled_mass"] * 4187 * 99


def test_heat_of_a_body_that_never_melts_is_booked_with_its_own_specific_heat():
    """It gets warmer than ice ever is, as what it is."""
    sim = stepped(kettle("solid.0.temperature=20", "solid.0.melting_point=never"), 12)
    assert sim.read("temperature")[sim.read("phase") == SOLID].max() > 40
    assert abs(sim.series()["heat_missing"]) < 1e-12 * sim.do.clock.ledger["start_heat"]


def test_heat_that_is_not_booked_shows():
    """The ledger can fail: a degree given to one particle of ice, or of water, is missing at once."""
    for phase in (SOLID, LIQUID):
        sim = Simulation(kettle(), "cpu")
        T = sim.state.read("temperature")
        i = np.flatnonzero(sim.state.read("phase") == phase)[0]
        T[i] += 1.0
        sim.state.set("temperature", T)
        own = sim.state.read("mass")[i] * (2050 if phase == SOLID else 4187)
        assert sim.series()["heat_missing"] == pytest.approx(own, rel=1e-6)


def test_ice_and_water_push_each_other_alike():
    """In free space nothing else pushes: a block of ice hits a block of water."""
    scene = scene_from_dict({
        "time": {"end": 1.0, "dt": 1 / 240},
        "domain": {"upper": [0.3, 0.2, 0.2], "spacing": 0.02, "gravity": [0, 0, 0], "walls": {"sides": []}},
        "fluid": {"fill": [{"lower": [0.1, 0.04, 0.04], "upper": [0.2, 0.16, 0.16]}]},
        "solid": [{"lower": [0.04, 0.06, 0.06], "upper": [0.1, 0.12, 0.12], "velocity": [0.5, 0.1, 0.0]}],
        "solver": {"pressure": "pbf", "precision": "double", "pbf": {"one_sided": True}},  # else the block contracts: speeds are cut
    })
    sim = Simulation(scene, "cpu")

    def momentum(phase):
        on = sim.read("phase") == phase
        return sim.read("mass")[on] @ sim.read("velocity")[on]

    ice, water = momentum(SOLID), momentum(LIQUID)
    for _ in range(20):
        sim.step()
    given, got = ice - momentum(SOLID), momentum(LIQUID) - water
    assert given[0] > 0.1 * ice[0]
    assert given == pytest.approx(got, abs=1e-13 * np.abs(ice).max())


@pytest.mark.parametrize("density, top_out", [(917.0, True), (2000.0, False)])
def test_ice_floats_at_its_depth_and_stone_sinks(density, top_out):
    """Volume balance: the water's level less the cube's bottom, in edges; within 0.04 as in weakly compressible water (V13)."""
    scene = scene_from_dict({
        "time": {"end": 2.0, "dt": 1 / 240},
        "domain": {"upper": [0.2, 0.2, 0.3], "spacing": 0.02},
        "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [0.2, 0.2, 0.16]}]},
        "solid": [{"lower": [0.06, 0.06, 0.08], "upper": [0.14, 0.14, 0.16], "density": density}],
        "solver": {"pressure": "pbf", "precision": "single"},
    })
    sim, found = Simulation(scene, "cpu"), []
    for k in range(300):
        sim.step()
        if k >= 200 and k % 5 == 0:
            phase, z = sim.read("phase"), sim.read("position")[:, 2] / 0.02
            bottom = z[phase == SOLID].mean() - 2
            level = ((phase == LIQUID).sum() - 16 * bottom) / (100 - 16)
            found.append((level - bottom) / 4)
    if top_out:
        assert abs(np.mean(found) - density / 1000) < 0.04
    else:
        assert bottom < 0.6  # on the floor


def test_a_run_goes_on_from_a_checkpoint_bit_by_bit_and_threads_do_not_matter():
    numba = pytest.importorskip("numba")
    whole, before = Simulation(kettle(), "cpu"), numba.get_num_threads()
    for _ in range(30):
        whole.step()
    assert 0 < whole.do.clock.melted < 32
    again = Simulation(kettle(), "cpu")
    again.restore(*whole.checkpoint())
    try:
        numba.set_num_threads(1)
        for _ in range(40):
            again.step()
    finally:
        numba.set_num_threads(before)
    for _ in range(40):
        whole.step()
    assert whole.series()["boiled"] > 0
    assert state(whole) == state(again) and whole.series() == again.series()


def test_cpu_and_emulated_cuda_agree_while_ice_melts_and_water_boils():
    overrides = ["solver.precision=single", "boiling.latent_scale=0", "fluid.temperature=99.9", "boiling.nucleation_time=0.02"]
    sim = Simulation(kettle(*overrides), "cpu", lockstep="cuda-emulated")
    for _ in range(25):
        sim.step()
    assert sim.do.clock.melted > 0 and sim.do.clock.ledger["boiled"] > 0
    assert max(found.ratio for found in sim.do.worst.values()) <= 1
    assert {"solid_correction", "goal_move", "bubble_avoid", "boiled_sums"} <= {stage for stage, _ in sim.do.worst}


def test_a_kettle_without_ice_pays_nothing_for_it():
    p = prepare(s := load_scene("kettle_small"), build(s))
    new = {"goal_move", "solid_correction", "bubble_avoid", "boiled_sums", "thermal_properties", "melt_test", "site_particle"}
    assert not new & set(p.stages)
    assert not {n for n in p.fields if n.startswith(("site", "region", "solid_", "latent_energy", "heat_capacity", "boiled"))}
    assert "boiled_mass" not in stepped(pot(), 1).series()
    with_ice = prepare(s := kettle(), build(s))
    assert new <= set(with_ice.stages) and not {"contact_force", "boil_exchange", "boil_content"} & set(with_ice.stages)


@pytest.mark.parametrize("overrides, words", [
    (["heat=none"], r"one heat for all of the tank: add \[heat\] with law = physical"),
    (["solid=none"], r"without heat \(\[heat\]; it is for solids that melt"),
    (["heat.law=paper"], "without heat.law = paper"),
    (["heat.refreeze=true"], "nothing freezes here; use wcsph or dfsph"),
    (["solver.pressure=sph"], r"without solids \(\[\[solid\]\]; in pbf there may be some\)"),
    (["solver.pbf.precision=true"], "solids have the full one"),
    (["solver.baseline=rigid"], "turns forces into motion"),
    (["boiling.mass_model=recycle"], "use cargo"),
    (["boiling.diffusivity=1e-5"], r"heat conducts as \[heat\] says"),
    (["heat.specific_heat=4000", "boiling.specific_heat=4200"], "are of one liquid: give it once"),
])
def test_what_does_not_go_together_is_refused_in_words(overrides, words):
    with pytest.raises(SceneError, match=words):
        load_scene("kettle_ice", overrides)
