"""A fast sheet of syrup hits a plate: nodes far from others carry much of the mass (ADR 21)."""

import numpy as np

from experiments.slime_coil import BASE, ONSET, RHO, WIDTH, scene_of
from melt.physics.phases import LIQUID
from melt.simulation import Simulation


def test_a_sheet_that_hits_a_plate_at_1_m_s_is_stable():
    """Without the bound on volumes: 97 m/s after 0.209 s."""
    flat, tall, Re, _ = ONSET["sheet, H/d 11, Re 0.42"]
    sim, most = Simulation(scene_of(flat, 0.25, RHO * WIDTH / Re, 1.0, tall * WIDTH, BASE["spacing"], 0.001), "cpu"), []
    while sim.time < 0.25 - 1e-9:
        sim.step()
        liquid = sim.read("phase") == LIQUID
        most.append(np.linalg.norm(sim.read("velocity")[liquid], axis=1).max())
    assert max(most) < 2  # it enters at 1 m/s, and falls 0.13 m
    heaviest = sim.read("mass")[liquid].max() / (RHO * BASE["spacing"] ** 2)
    assert heaviest > 2 and sim.read("volume")[liquid].max() <= 2.0001 * BASE["spacing"] ** 2
