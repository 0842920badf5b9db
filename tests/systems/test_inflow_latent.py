"""Liquid that flows in brings its latent heat: it is not taken for ice that has yet to melt."""

import numpy as np
import pytest
from extreme_scenes import scene

from melt.simulation import Simulation


@pytest.mark.parametrize("backend", ["cpu", "reference", "cuda-emulated"])
def test_hot_inflow_stays_hot(backend):
    hot = scene(
        fluid={"fill": []},
        solid=[{"position": [0.4, 0.4, 0.0], "size": [0.4, 0.4, 0.4], "anchor": "base", "conductivity": 0}],
        heat={"latent": True, "refreeze": True, "conductivity": 0},
        inflow=[{"position": [0.4, 0.4, 1.0], "direction": [0, 0, -1], "radius": 0.2, "speed": 2.0,
                 "temperature": 40.0, "layers": 1}],
    )
    sim = Simulation(hot, backend)
    for _ in range(3):
        sim.step()
    wet = sim.read("phase") == 0
    assert wet.any() and (sim.read("temperature")[wet] == 40).all()
    assert np.array_equal(sim.read("latent_energy")[wet], sim.read("latent_capacity")[wet])
    assert (sim.read("latent_energy")[wet] > 0).all()
