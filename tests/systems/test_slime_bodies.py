"""Forces of incompressible liquids on moving bodies, and liquid without a surface."""

import numpy as np
import pytest
from slime_scenes import liquid, pool, slime, sound

from melt.simulation import Simulation


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
            assert change == pytest.approx(given - total, abs=1e-6 * -weight)
    assert after["force/body/shear_x"] < 0 and after["force/floor/pressure_z"] < 0 < after["force/right/pressure_x"]


def test_forces_of_halved_steps_are_means_and_bodies_without_a_name_go_by_their_place():
    """Water at rest on obstacles: a step in four pieces has the force of one, not four times as much."""
    sides = [(-0.9, 0.9, -0.3, 0.0), (-0.9, -0.6, 0.0, 1.2), (0.6, 0.9, 0.0, 1.2)]
    basin = [{"lower": [a, -1, c], "upper": [b, 1, d], "force": k == 0} for k, (a, b, c, d) in enumerate(sides)]
    solver = {"pressure": "dfsph", "apic": None, "ghosts": None}
    scene, found = pool(domain={"walls": {"sides": ["none"]}}, obstacle=basin[1:] + basin[:1], solver=solver), {}
    for halvings in (0, 2):
        sim = Simulation(scene, "cpu")
        sim.do.clock.halvings = halvings
        for _ in range(4):
            sim.step()
        s = sim.series()
        found[halvings] = s["force/obstacle 2/pressure_z"] / (s["mass"] * -9.81)
        assert s["density_iterations"] >= 2 * 2**halvings
    assert found[0] == pytest.approx(1, abs=0.2) and found[2] == pytest.approx(1, abs=0.2)


def test_liquid_in_an_accelerated_box_moves_with_it():
    """Walls carry the pressure of their acceleration, as they carry that of gravity: no layer lags behind."""
    parts = [(-0.9, 0.9, -0.3, 0.0), (-0.9, 0.9, 1.0, 1.3), (-0.9, -0.6, 0.0, 1.0), (0.6, 0.9, 0.0, 1.0)]
    motion = [[0, 0, 0, 0], [1, 2.0, 0, 1.0]]
    box = [{"name": "box", "lower": [a, -1, c], "upper": [b, 1, d], "motion": motion, "force": True} for a, b, c, d in parts]
    whole = {"fill": [{"lower": [-0.6, -1.0, 0.0], "upper": [0.6, 1.0, 1.0]}], "enclosed": True}
    solver = {"pressure": "isph", "apic": None, "ghosts": None, "dfsph": {"poisson_tolerance": 1e-10}}
    sim = Simulation(slime(fluid=whole, obstacle=box, solver=solver, domain={"lower": [-1.2, 0, -0.6], "upper": [1.2, 0, 1.6]}), "cpu")
    for _ in range(10):
        sim.step()
    s = sound(sim)
    assert np.abs(liquid(sim, "velocity") - [2 * 0.095, 0, 0.095]).max() < 1e-3
    mass = s["mass"]
    assert [s[f"force/box/pressure_{axis}"] for axis in "xz"] == pytest.approx([-2 * mass, -mass], rel=1e-3)


def test_a_full_box_stays_in_order_by_the_shift_alone():
    """Vortices in a closed box: where pressure is negative, liquid without a shift tears."""
    box = {"lower": [0, 0, 0], "upper": [1.2, 0, 1.2], "walls": {"sides": ["all"]}}
    whole = {"fill": [{"lower": [0, -1, 0], "upper": [1.2, 1, 1.2]}], "enclosed": True}
    flow = {"kind": "rotation", "rate": 2.0, "centre": [0.6, 0, 0.6]}
    spread = {}
    for shift in (0.0, 0.1):
        solver = {"pressure": "isph", "apic": None, "ghosts": None, "support": 3.0, "dfsph": {"shift": shift, "pull": 0}}
        sim = Simulation(slime(domain=box, fluid={**whole, "flow": flow}, solver=solver), "cpu")
        for _ in range(50):
            sim.step()
        assert sound(sim)["poisson_residual"] <= 1e-4
        spread[shift] = liquid(sim, "density_ratio").std()
    assert spread[0.1] < 0.5 * spread[0.0], spread
