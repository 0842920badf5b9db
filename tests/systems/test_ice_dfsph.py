"""Ice that melts in incompressible water: long steps, nothing lost (melting 3.5, slime 2.7)."""

import pytest
from scene_runs import stepped

from melt.scene import load_scene


def test_ice_melts_in_incompressible_water_and_mass_and_heat_stay():
    sim = stepped(load_scene("ice_dfsph", ["heat.conductivity_scale=6e6"]), 12)
    s = sim.series()
    assert s["melted"] > 0
    assert s["n_sub"] == 1 and 2 <= s["density_iterations"] < 40  # weakly compressible water takes 6 sub-steps of 10 ms
    assert abs(s["mass_created"]) < 1e-8 * s["mass"]
    start = stepped(load_scene("ice_dfsph"), 0).series()
    heat = s["thermal_energy"] + s["latent_energy"]
    assert heat == pytest.approx(start["thermal_energy"] + start["latent_energy"], abs=3e-6 * s["latent_energy"])  # mixed precision
    assert s["latent_energy"] > 1e7
