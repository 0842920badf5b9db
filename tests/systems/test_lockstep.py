"""A live run on two backends: they agree stage by stage, and a planted fault is named."""

import pytest

from melt.bind import LockstepError
from melt.cuda import motion
from melt.scene import load_scene
from melt.simulation import Simulation


def test_cpu_and_emulated_cuda_agree_on_a_live_run():
    scene = load_scene("ice_cube_small", ["solid.0.position=[1.5, 1.3, 1.4]"])
    sim = Simulation(scene, "cpu", lockstep="cuda-emulated")
    for _ in range(2):
        sim.step()
    worst = sim.do.worst
    assert max(found.ratio for found in worst.values()) <= 1
    assert {"fluid_force", "region_match", "heat_pairs_coloured"} <= {stage for stage, _ in worst}


def test_a_fault_is_named_with_stage_field_and_particle(monkeypatch):
    right = motion.drift

    def wrong(phase, velocity, dt, position):
        right(phase, velocity, dt, position)
        position[1, 7] += 0.5

    monkeypatch.setattr(motion, "drift", wrong)
    sim = Simulation(load_scene("tank_small"), "cpu", lockstep="cuda-emulated")
    with pytest.raises(LockstepError, match=r"stage drift, field position, particle 7"):
        sim.step()
