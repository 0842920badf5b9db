"""Only what a scene requires is allocated and launched."""

import numpy as np
import pytest

from melt.constants import lattice_offsets, list_capacity
from melt.fields import FIELDS
from melt.geometry.build import build
from melt.plan import prepare
from melt.preflight import plan
from melt.scene import load_scene, scene_from_dict
from melt.simulation import Simulation

SOLID_FIELDS = {n for n, f in FIELDS.items() if "site" in f.shape}
HEAT_FIELDS = {n for n in FIELDS if n.startswith(("temperature", "heat_", "latent_", "conductivity", "cg_"))}
FLUID = {
    "time": {"end": 0.02},
    "domain": {"upper": [1.6, 1.2, 1.2], "spacing": 0.2},
    "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [0.8, 1.2, 0.8]}]},
}


def prepared(scene):
    return prepare(scene, build(scene))


def test_a_fluid_has_no_temperature_and_no_sites():
    p = prepared(scene_from_dict(FLUID))
    assert not SOLID_FIELDS & set(p.fields)
    assert not HEAT_FIELDS & set(p.fields)
    assert not [s for s in p.stages if s.startswith(("heat", "melt", "region", "goal", "thermal", "contact", "site"))]


def test_a_warm_fluid_has_temperature_but_no_sites():
    p = prepared(scene_from_dict({**FLUID, "heat": {}}))
    assert "temperature" in p.fields and "thermal_properties" in p.stages
    assert not SOLID_FIELDS & set(p.fields)
    assert not {"latent_energy", "latent_capacity"} & set(p.fields)


def test_latent_heat_is_allocated_only_when_on():
    assert "latent_energy" not in prepared(load_scene("ice_cube_small")).fields
    assert "latent_energy" in prepared(load_scene("ice_cube_small", ["heat.latent=true", "heat.law=physical"])).fields


@pytest.mark.parametrize("overrides", [[], ["solver.neighbours=kdtree"], ["solver.guard=false"]])
def test_a_run_launches_what_the_plan_lists_and_nothing_else(overrides):
    sim = Simulation(load_scene("tank_small", overrides), "cpu")
    sim.step()
    assert set(sim.do.launches) == set(sim.prepared.stages)
    assert set(sim.state.arrays) == set(sim.prepared.fields)


def test_a_full_scene_launches_nothing_unplanned():
    sim = Simulation(load_scene("ice_cube_small"), "cpu")
    for _ in range(2):
        sim.step()
    assert set(sim.do.launches) <= set(sim.prepared.stages)


def test_memory_of_the_plan_is_memory_of_the_run():
    sim = Simulation(scene_from_dict(FLUID), "cpu")
    assert sim.state.nbytes == sim.prepared.nbytes


def test_plan_lines_name_stages_fields_bytes_and_bounds():
    text = "\n".join(plan(load_scene("ice_cube_small")).lines())
    for word in ("fluid_force", "neighbour_index", "MB", "sound", "governs", "sub-steps", "Fourier"):
        assert word in text


def test_overlap_is_a_finding_with_a_fix():
    scene = scene_from_dict(FLUID)
    initial = build(scene)
    x = initial.arrays["position"]
    x[:, 1] = x[:, 0] + 0.05
    found = [f for f in plan(scene, initial=initial).findings if "closer" in f.text]
    assert found and found[0].level == "warning" and found[0].fix


def test_thin_walls_are_a_finding():
    scene = scene_from_dict({**FLUID, "domain": {**FLUID["domain"], "walls": {"layers": 1}}})
    assert any("thinner" in f.text for f in plan(scene).findings)


def test_far_single_precision_is_a_finding():
    far = {"lower": [2000.0, 0, 0], "upper": [2001.6, 1.2, 1.2], "spacing": 0.2}
    fluid = {"fill": [{"lower": [2000.0, 0, 0], "upper": [2000.8, 1.2, 0.8]}]}
    scene = scene_from_dict({**FLUID, "domain": far, "fluid": fluid, "solver": {"precision": "single"}})
    assert any("float32" in f.text and "mixed" in f.fix for f in plan(scene).findings)


def test_capacity_of_lists_grows_without_changing_results():
    def end(capacity):
        sim = Simulation(load_scene("tank_small", [f"solver.max_neighbours={capacity}"]), "cpu")
        for _ in range(3):
            sim.step()
        return sim.read("position"), sim.state.sizes["neighbour"]

    (small, grown), (wide, kept) = end(20), end(160)
    assert grown > 20 and kept == 160
    assert np.array_equal(small, wide)


def test_capacity_of_lists_follows_the_support():
    """Room for the lattice at rest and a third more at any support, in rows of whole cache lines; a given number is kept."""
    assert [list_capacity(ratio) for ratio in (1.6, 2.0, 2.2, 2.5, 3.0)] == [32, 48, 64, 96, 160]
    for ratio in np.arange(1.01, 6.01, 0.01):
        assert list_capacity(ratio) % 16 == 0 and list_capacity(ratio) > lattice_offsets(ratio).size
        assert list_capacity(ratio) >= 4 / 3 * (4 / 3 * np.pi * ratio**3)
    sizes = [prepared(scene_from_dict({**FLUID, "solver": s})).sizes["neighbour"] for s in ({}, {"support": 2.0}, {"max_neighbours": 77})]
    assert sizes == [96, 48, 77]
