"""Runs of incompressible liquids: repeatability, resumption, two backends in step, ledgers, inflow, moving bodies."""

import numba
import numpy as np
import pytest
from scene_runs import datasets, stepped
from slime_scenes import RHO, D, carriers, liquid, pool, slime, sound, square

from melt import simulation
from melt.output.run_reader import open_run
from melt.physics.phases import DRIVEN, WALL
from melt.scene import load_scene
from melt.simulation import Simulation

LOW = ["inflow.0.position=[0,0,0.012]", "inflow.0.speed=0.4"]  # liquid reaches the plate within 20 steps



# ---- forces on bodies


@pytest.mark.parametrize("solver", [{"pressure": "hybrid"}, {"pressure": "dfsph", "ghosts": None}])
def test_the_forces_on_all_bodies_are_what_the_liquid_lacks_of_its_weight(solver):
    """A basin of measured obstacles and a body that moves in it: impulses of the liquid, and where each comes from."""
    sides = [("floor", -0.9, 0.9, -0.3, 0.0), ("left", -0.9, -0.6, 0.0, 1.2), ("right", 0.6, 0.9, 0.0, 1.2)]
    bodies = [{"name": n, "lower": [a, -1, c], "upper": [b, 1, d], "force": True} for n, a, b, c, d in sides]
    bodies.append({"name": "body", "lower": [-0.4, -1, 0.3], "upper": [-0.2, 1, 0.5], "velocity": [0.2, 0, 0], "force": True})
    scene = pool(domain={"walls": {"sides": ["none"]}}, obstacle=bodies, viscosity={"mu": 20, "tolerance": 1e-12},
                 solver={"apic": None, "dfsph": {"density_tolerance": 1e-9, "max_iterations": 3000}, **solver})
    sim = Simulation(scene, "cpu")
    for _ in range(5):
        before, dt = sim.series(), sim.scene.time.dt
        sim.step()
        after = sim.series()
        weight = after["mass"] * -9.81
        for axis, given in (("x", 0.0), ("z", weight)):
            total = sum(value for name, value in after.items() if name.startswith("force/") and name.endswith(f"_{axis}"))
            change = (after[f"momentum_{axis}"] - before[f"momentum_{axis}"]) / dt
            assert change == pytest.approx(given - total, abs=1e-4 * -weight)
    assert after["force/body/shear_x"] < 0 and after["force/floor/pressure_z"] < 0 < after["force/right/pressure_x"]
