"""Incompressible liquids whose solves do not converge, and values that are not finite."""

import re

import numpy as np
import pytest
from slime_scenes import TURNING, carriers, liquid, pool, slime, sound

from melt import simulation
from melt.errors import InputError, MeltError
from melt.geometry.build import build
from melt.output.run_reader import open_run
from melt.simulation import Simulation
from melt.stages import STAGES

HARD = {"poisson_iterations": 4, "poisson_tolerance": 1e-12, "retries": 2}


def state(sim):
    """What a sub-step must leave as it was: by id."""
    return [liquid(sim, "position"), *carriers(sim, "apic_position", "apic_velocity", "apic_affine", "apic_mass")]


@pytest.mark.parametrize("sections", [{}, {"semi_lagrangian": True}])
@pytest.mark.parametrize("on_fail", ["retry", "raise"])
def test_a_solve_that_does_not_converge_stops_the_run_before_its_step(on_fail, sections):
    sim = Simulation(slime(fluid=TURNING, solver={"dfsph": HARD | {"on_fail": on_fail} | sections}), "cpu")
    before = state(sim)
    said = r"t = 0 s a sub-step of (\S+) s has not converged \(poisson solve after 4 iterations: .*frames before are kept.*on_fail = 'warn'"
    with pytest.raises(MeltError, match=said) as caught:
        sim.step()
    length = float(re.search(said, str(caught.value))[1])
    assert length == pytest.approx(0.0025 if on_fail == "retry" else 0.01)
    assert sim.do.notes.get("retries", 0) == (2 if on_fail == "retry" else 0)
    assert all(np.array_equal(a, b) for a, b in zip(before, state(sim)))


def test_a_warning_marks_the_frames_and_the_run_goes_on(tmp_path):
    told, path = [], tmp_path / "run.vtkhdf"

    def progress(event, message="", **_):
        told.extend([message] if event == "warning" else [])

    scene = slime(fluid=TURNING, solver={"dfsph": HARD | {"on_fail": "warn"}}, time={"end": 0.1, "output_every": 0.02})
    done = simulation.run(scene, path, backend="cpu", progress=progress)
    assert done.simulation.do.clock.step == 10
    assert sum("has not converged (poisson" in text and "Fix:" in text for text in told) == 1
    with open_run(path) as run:
        assert len(run) == 6 and list(run.series["unconverged"][1:]) == [1] * 5
        assert (run.series["poisson_residual"][1:] > 1e-12).all()


def test_a_sub_step_that_needs_halves_is_taken_in_halves():
    """DFSPH needs fewer iterations in a shorter step."""
    def scene(retries):
        water = {"pressure": "dfsph", "apic": None, "ghosts": None, "dfsph": {"max_iterations": 12, "retries": retries}}
        return pool(fluid={"jitter": 0.0}, solver=water, time={"dt": 0.02})

    with pytest.raises(MeltError, match="has not converged"):
        hard = Simulation(scene(0), "cpu")
        for _ in range(10):
            hard.step()
    sim = Simulation(scene(4), "cpu")
    retried = 0
    for _ in range(10):
        sim.step()
        retried += sound(sim).get("retries", 0)
    assert retried > 0 and sim.time == pytest.approx(0.2)


# ---- values that are not finite


def plant(sim, name, of, number, value):
    values = sim.state.read(name)
    values[..., int(np.flatnonzero(sim.state.read(of) == number)[0])] = value
    sim.state.set(name, values)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize(("name", "of", "who"), [
    ("apic_velocity", "apic_id", "APIC particle 5"), ("apic_affine", "apic_id", "APIC particle 5"),
    ("apic_position", "apic_id", "APIC particle 5"), ("apic_mass", "apic_id", "APIC particle 5"),
    ("position", "id", "particle 5"), ("poisson_pressure", "id", "particle 5"),
])  # fmt: skip
def test_a_value_that_turns_bad_is_named_with_its_field_particle_and_stage(name, of, who, value):
    sim = Simulation(slime(fluid=TURNING), "cpu")
    for _ in range(2):
        sim.step()
    plant(sim, name, of, 5, value)
    with pytest.raises(MeltError, match=r"step 3, t = 0.03 s: .*frames before are kept") as caught:
        sim.step()
    found = re.search(r"field (\w+) \(stage ([\w :]+)\) is not finite at ((?:APIC )?particle \d+)", str(caught.value))
    assert found, str(caught.value)
    assert all(stage in STAGES for stage in found[2].split(" or ")) or found[2].startswith("none")
    # a node that is nowhere has no velocity either, and that is written first
    assert found[1] in ((name, "velocity") if name == "position" else (name,)) and found[3] == who, str(caught.value)


NODES_ALONE = {"pressure": "dfsph", "apic": None, "ghosts": None}


def test_without_apic_particles_too():
    sim = Simulation(slime(fluid=TURNING, viscosity={"mu": 1.0}, solver=NODES_ALONE), "cpu")
    for _ in range(2):
        sim.step()
    plant(sim, "velocity", "id", 5, np.nan)
    with pytest.raises(MeltError, match=r"field velocity \(stage .*particle 5"):
        sim.step()


@pytest.mark.parametrize("name", ["density_impulse", "divergence_impulse"])
def test_a_first_guess_that_is_no_number_is_none(name):
    sims = [Simulation(slime(fluid=TURNING, solver=NODES_ALONE), "cpu") for _ in range(2)]
    for sim in sims:
        sim.step()
    for sim, value in zip(sims, (0.0, np.nan)):
        plant(sim, name, "id", 5, value)
        sim.step()
        sound(sim)
    assert np.array_equal(sims[0].read("position"), sims[1].read("position"))


def test_bad_apic_values_at_the_start_are_refused():
    initial = build(slime())
    initial["apic_mass"][7] = np.nan
    with pytest.raises(InputError, match=r"apic_mass\[7\] = nan kg"):
        Simulation(slime(), "cpu", initial=initial)
