"""Running ledgers: heat brought in by sources, particles melted and frozen; the warning of a step over its limit."""

import numpy as np
import pytest
from extreme_scenes import scene
from scene_runs import stepped

from melt import simulation
from melt.errors import MeltError
from melt.output.checkpoint import load, save
from melt.preflight import plan
from melt.simulation import Simulation

RATE = {"heater": [{"position": [0.4, 0.4, 0.2], "size": [0.5, 0.5, 0.3], "rate": 200.0}]}
AMBIENT = {"ambient_temperature": -20.0, "ambient_transfer": 5.0}


def stored(values):
    return values["thermal_energy"] + values.get("latent_energy", 0.0)


def balance(heat, precision="double", backend="cpu", steps=40, **sections):
    """Return (heat stored more than at the start, energy_in, size of both) after some steps."""
    sim = Simulation(scene(heat=heat, solver={"precision": precision}, **sections), backend)
    before = sim.series()
    for _ in range(steps):
        sim.step()
    after = sim.series()
    return stored(after) - stored(before), after["energy_in"], abs(stored(before)) + abs(after["energy_in"])


@pytest.mark.parametrize("precision", ["single", "mixed", "double"])
@pytest.mark.parametrize(
    "heat", [RATE, AMBIENT, {**RATE, **AMBIENT, "latent": True}], ids=["heater", "air", "all, latent"]
)
def test_stored_heat_minus_what_sources_brought_stays(heat, precision):
    gained, brought, size = balance(heat, precision)
    assert abs(brought) > 0.05 * size
    # double: round-off of a sum; single: as the solver itself conserves
    assert abs(gained - brought) <= (1e-14 if precision == "double" else 1e-6) * size


@pytest.mark.parametrize("refreeze", [False, True])
def test_melting_away_from_0_degc_makes_no_heat(refreeze):
    """Ice of another specific heat that melts at 10 degC, in warm air, whether its melt could freeze again or not."""
    warm = scene(
        fluid={"temperature": 60.0},
        solid=[{"position": [0.4, 0.4, 0.6], "size": [0.4, 0.4, 0.4], "anchor": "base", "conductivity": 1e8,
                "specific_heat": 2100.0, "melting_point": 10.0, "temperature": 0.0, "latent_heat": 1e4}],
        heat={"law": "physical", "latent": True, "conductivity": 1e8, "refreeze": refreeze},
        solver={"motion": False, "melt_to": "own", "density_form": "volume", "precision": "double"},
    )
    sim = Simulation(warm, "cpu")
    before = sim.series()
    for _ in range(60):
        sim.step()
    after = sim.series()
    assert after["melted"] == 8 and after["thermal_energy"] > 0
    assert abs(stored(after) - stored(before)) <= 1e-12 * abs(before["thermal_energy"])


def test_a_heater_brings_its_rate():
    """8 particles of 0.008 m^3 in the box, 200 K/s for 0.2 s: 2.56 K m^3, whatever the heat exchange does."""
    for solver in ("pairs_coloured", "cg", "onesided"):
        brought = balance({**RATE, "solver": solver}, domain={"gravity": [0, 0, 0]})[1]
        assert brought == pytest.approx(8 * 0.008 * 200 * 0.2, rel=1e-12)


def test_what_the_solver_loses_is_not_hidden():
    """The one-sided sweeps do not conserve: stored heat and heat brought in part."""
    gained, brought, size = balance({**RATE, "solver": "onesided", "conductivity": 500}, steps=10)
    assert abs(gained - brought) > 1e-9 * size


@pytest.mark.parametrize("backend", ["reference", "cuda-emulated"])
def test_twins_bring_the_same(backend):
    heat = {**RATE, **AMBIENT, "latent": True}
    assert balance(heat, backend=backend, steps=5)[1] == pytest.approx(balance(heat, steps=5)[1], rel=1e-12)


def test_scenes_without_sources_do_not_count():
    sim = stepped(scene(), 2)
    assert "energy_in" not in sim.series() and "heat_content" not in sim.do.launches
    assert "frozen" not in sim.series()


def test_melted_and_frozen_are_counted_from_the_start_and_after_resume(tmp_path):
    """Nobody moves: the body of 8 in hot water melts whole; half of what is there is chilled and freezes to its sites."""
    still = scene(
        fluid={"temperature": 90.0, "fill": [{"lower": [0, 0, 0], "upper": [0.8, 0.8, 1.0]}]},
        solid=[{"position": [0.4, 0.4, 0.4], "size": [0.4, 0.4, 0.4], "anchor": "base", "conductivity": 30}],
        heat={"refreeze": True, "nuclei": 1},
        solver={"motion": False},
    )
    sim = Simulation(still, "cpu")
    for _ in range(60):
        sim.step()
    # not those of the last step alone
    assert sim.series()["melted"] == 8 and sim.series()["solid_particles"] == sim.series()["frozen"] == 0
    cold = np.where(sim.state.read("position")[2] < 0.5, -90.0, 90.0)
    sim.state.set("temperature", cold)
    for _ in range(3):
        sim.step()
    s = sim.series()
    assert s["frozen"] > 5 and s["melted"] >= 8 and s["frozen"] - s["melted"] + 8 == s["solid_particles"]
    save(tmp_path / "c", *sim.checkpoint())
    again = Simulation(still, "cpu")
    again.restore(*load(tmp_path / "c"))
    for one in (sim, again):
        one.step()
    assert again.series()["frozen"] == sim.series()["frozen"] >= s["frozen"]
    assert again.series()["melted"] == sim.series()["melted"]
    assert np.array_equal(again.read("phase"), sim.read("phase"))


def test_a_step_over_its_limit_is_one_line_in_plan_and_in_the_run():
    over = scene(time={"n_sub": 1, "end": 0.02}, fluid={"sound_speed": 100.0})
    found = [str(f) for f in plan(over).findings if f.level == "warning"]
    assert len(found) == 1
    for part in ("time.n_sub = 1", "bound 'sound' allows 0.000893 s", "Fix: time.n_sub = 6", "fluid.sound_speed below"):
        assert part in found[0]
    said = warnings_of(over)
    assert len([w for w in said if "time.n_sub" in w]) == 1


def test_a_bound_that_is_exceeded_later_is_told_once():
    """A drop that gravity makes fast: at the start the given sub-step is fine."""
    late = scene(
        time={"n_sub": 1, "end": 0.3},
        domain={"gravity": [0, 0, -500.0], "walls": {"sides": ["none"]}},
        fluid={"sound_speed": "legal", "fill": [{"lower": [0, 0, 0], "upper": [0.2, 0.2, 0.2]}]},
        solid=[],
        heat=None,
    )
    assert not [f for f in plan(late).findings if "time.n_sub" in f.text]
    said = [w for w in warnings_of(late) if "time.n_sub" in w]
    assert len(said) == 1 and "bound 'speed'" in said[0] and "Fix: time.n_sub = 2, or 'auto'" in said[0]


def test_automatic_sub_steps_that_do_not_do_are_refused_by_plan():
    with pytest.raises(MeltError, match=r"56 of them in dt = 0.005 s, but time.n_sub_max is 16 .* lower fluid.sound_speed"):
        plan(scene(fluid={"sound_speed": 1000.0}))


def warnings_of(scene):
    said = []
    simulation.run(scene, backend="cpu", progress=lambda e, message="", **_: said.append(message) if e == "warning" else 0)
    return said
