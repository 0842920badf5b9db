"""Spec 6 of boiling: unstable numbers, heaters that do nothing, values that are none, seeds, long runs, condensate."""

import re

import numpy as np
import pytest
from boiling_scenes import AT_ONCE, HOT, D, N, bits, notes_of, pot, sound, stepped, tank, warnings_of

from melt.boiling import birth_radius, heater_box
from melt.errors import InputError, MeltError, SceneError
from melt.geometry.build import build
from melt.physics.phases import BUBBLE, LIQUID
from melt.scene import load_scene
from melt.simulation import Simulation

# ---- the solver's numbers


@pytest.mark.parametrize("pbf, words", [
    ("eps_rel=0.01", r"eigenvalue 2\.98 is 2\.95, above 2 the solve diverges.*raise eps_rel"),
    ("omega=1.5", r"is 2\.2\d, above 2 the solve diverges.*lower omega"),
    ("iterations=0", "iterations = 0 is not allowed: it must be at least 1"),
])
def test_an_unstable_solve_is_refused(pbf, words):
    with pytest.raises(SceneError, match=words):
        pot(f"solver.pbf.{pbf}")


@pytest.mark.parametrize("pressure", ["pbf", "sph"])
def test_a_support_below_1_6_spacings_is_refused(pressure):
    with pytest.raises(SceneError, match=r"solver.support = 1\.59 is too short.*at least 1\.6"):
        pot("solver.support=1.59", f"solver.pressure={pressure}")
    sound(stepped(pot("solver.support=1.6", "time.n_sub_max=64", f"solver.pressure={pressure}"), 2))
    if pressure == "pbf":
        with pytest.raises(SceneError, match=r"minimum_support.*at least 1\.6"):
            pot("solver.pbf.minimum_support=1.5", "solver.pbf.precision=true")


def test_doubtful_numbers_of_the_solve_are_warned_of():
    assert any("one iteration" in text for text in warnings_of(pot("solver.pbf.iterations=1")))
    assert any("omega' Lmax = 1.71" in text for text in warnings_of(pot("solver.pbf.omega=1.15")))
    assert not warnings_of(pot())
    sound(stepped(pot(*HOT, "solver.pbf.iterations=1", "time.n_sub_max=64"), 20))
    sound(stepped(pot(*HOT, "solver.pbf.precision=true", "solver.pbf.minimum_precision=0", "solver.pbf.minimum_iterations=1"), 20))


# ---- heat


@pytest.mark.parametrize("overrides", [
    ["boiling.heater.centre=[5,5]"], ["boiling.heater.centre=[-0.2,0.1]", "boiling.heater.half_size=[0.1,0.1]"],
])
def test_a_heater_that_is_off_boils_nothing_and_keeps_the_mean_temperature(overrides):
    scene = pot("fluid.temperature=99.9", "boiling.latent_scale=0", "boiling.nucleation_time=0", *overrides)
    assert any(re.search(r"boiling.heater: no part of it is on the floor, x 0 to 0.24, y 0 to 0.24 m", t) for t in warnings_of(scene))
    initial = build(scene)
    liquid = initial["phase"] == LIQUID
    initial["temperature"][liquid] = 20 + 79 * np.random.default_rng(1).random(N)
    sim = stepped(scene, 60, initial)
    s = sound(sim)
    assert s["bubbles"] == s["boiled"] == 0 and s["heat_in"] == 0
    assert s["temperature_mean"] == pytest.approx(initial["temperature"][liquid].mean(), rel=1e-12)
    assert "boil_heater" not in sim.prepared.stages


def test_without_a_heater_it_says_so_and_zero_area_is_refused():
    scene = tank((4, 4), 4, boiling={"heater": None})
    assert "there is no heater" in notes_of(scene) and not warnings_of(scene)
    assert sound(stepped(scene, 10))["boiled"] == 0
    with pytest.raises(SceneError, match=r"half_size.*greater than 0"):
        pot("boiling.heater.half_size=[0, 0.1]")


@pytest.mark.parametrize("mode", ["robin", "dirichlet"])
def test_a_heater_below_the_boiling_point_never_boils(mode):
    scene = pot("fluid.temperature=99", "boiling.latent_scale=0", "boiling.nucleation_time=0", "boiling.heater.temperature=99.9",
                f"boiling.heater.mode={mode}")
    assert "is not above the boiling point" in notes_of(scene)
    s = sound(stepped(scene, 120))
    assert s["boiled"] == 0 and 99 < s["temperature_max"] <= 99.9


def test_a_heater_larger_than_the_floor_is_cut_to_it():
    large, whole = (pot(*HOT, f"boiling.heater.half_size=[{size}, {size}]") for size in (7, 0.12))
    assert np.array_equal(heater_box(large), [[0, 0], [0.24, 0.24]])
    assert "boiling.heater is cut to the floor" in notes_of(large) and "is cut" not in notes_of(whole)
    assert bits(stepped(large, 20)) == bits(stepped(whole, 20))
    corner = pot("boiling.heater.centre=[0.24, 0.24]", "boiling.heater.half_size=[0.1, 0.1]")
    assert np.allclose(heater_box(corner), [[0.14, 0.14], [0.24, 0.24]])


@pytest.mark.parametrize("model", ["particle", "particle10", "grid"])
def test_unstable_conduction_is_sub_cycled_and_never_overshoots(model):
    scene = pot("boiling.diffusivity=1.0", f"boiling.heat_model={model}", "boiling.boost=off", "boiling.heater.temperature=90")
    initial = build(scene)
    liquid = initial["phase"] == LIQUID
    initial["temperature"][liquid] = np.where(initial["position"][0, liquid] < 0.12, 20.0, 99.0)
    sim = Simulation(scene, "cpu", initial=initial)
    low, high = (20.0, 99.0) if model != "grid" else (90.0, 95.0)  # its cells start at fluid.temperature
    for _ in range(5):
        sim.step()
        s = sound(sim)
        assert s["conduction_steps"] > 10
        assert low - 1e-9 <= s["temperature_min"] <= s["temperature_max"] <= high + 1e-9
    assert s["temperature_max"] - s["temperature_min"] < 40


def test_conduction_that_no_sub_cycle_could_follow_is_refused():
    with pytest.raises(MeltError, match="conduction asks for .* more than 10000: lower boiling.diffusivity"):
        Simulation(pot("boiling.diffusivity=1e9"), "cpu").step()


def test_the_plan_tells_what_is_not_physical():
    text = notes_of(pot("boiling.latent_scale=0", "boiling.vapour.per_burst=2"))
    assert "conducts with 0.0024 m^2/s, 1.5e+04 times as fast as in water" in text
    assert "boiling is free of charge (boiling.latent_scale = 0)" in text
    assert "a particle is 0.008 kg of liquid, and its four bubbles would hold 4.8e-06 kg of steam, 1/1,667 of it" in text
    assert "slots for 2,304 bubbles, those of 576 of 1,152 liquid particles at once" in text
    assert "for 1,152 vapour particles, those of 576 bursts within 3 s" in text
    assert "free of charge" not in notes_of(pot())
    assert "1 times as fast as in water" in notes_of(pot("boiling.diffusivity=1.6e-7"))
    assert "heat_model = grid has no latent heat" in notes_of(pot("boiling.heat_model=grid"))
    assert "conducts" not in notes_of(load_scene("dam_break_small"))


# ---- not a number


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", ["position", "velocity", "temperature"])
def test_bad_values_at_the_start_are_refused_by_name(name, value):
    scene = pot()
    initial = build(scene)
    initial.arrays[name][..., 30] = value
    with pytest.raises(InputError, match=rf"{name}\[[012, ]*30\] = -?(nan|inf)"):
        Simulation(scene, "cpu", initial=initial)


def boiling_run(pressure):
    return stepped(pot("fluid.temperature=99", "boiling.latent_scale=0", "boiling.nucleation_time=0.05", "boiling.heater.temperature=130",
                       f"solver.pressure={pressure}", "time.n_sub_max=64"), 40)


@pytest.mark.parametrize("pressure", ["pbf", "sph"])
@pytest.mark.parametrize("phase, name, value", [
    *((phase, name, np.nan) for phase in (LIQUID, BUBBLE) for name in ("position", "velocity", "temperature")),
    (LIQUID, "velocity", np.inf), (LIQUID, "temperature", np.inf), (LIQUID, "temperature", -np.inf), (LIQUID, "latent_store", np.nan),
    (BUBBLE, "velocity", -np.inf), (BUBBLE, "bubble_volume", np.nan), (BUBBLE, "bubble_volume", np.inf), (BUBBLE, "age", np.nan),
])
def test_a_value_that_turns_bad_names_step_field_and_particle(phase, name, value, pressure):
    sim = boiling_run(pressure)
    slots = np.flatnonzero(sim.state.read("phase") == phase)
    slot = slots[slots.size // 2]
    particle = sim.state.read("id")[slot]
    values = sim.state.read(name)
    values[..., slot] = value
    sim.state.set(name, values)
    with pytest.raises(MeltError, match=r"step 41, t = .* frames before are kept") as caught:
        sim.step()
    text = str(caught.value)
    field, culprit = re.search(r"field (\w+) \(stage [\w ]+\) is not finite at particle (\d+)", text).groups()
    assert "\n" not in text
    bad = sim.state.read(field)[..., sim.state.read("id") == int(culprit)]
    assert not np.isfinite(bad).all()
    if name in ("temperature", "latent_store"):
        assert field.removesuffix("_next") == name and int(culprit) == particle


# ---- far away, random numbers, long runs


def far(lower, precision):
    high = [c + s for c, s in zip(lower, (0.24, 0.24, 0.36))]
    return pot(
        *HOT, f"domain.lower={lower}", f"domain.upper={high}", "boiling.boost=off",
        f"fluid.fill=[{{lower={lower},upper=[{high[0]},{high[1]},{lower[2] + 0.16}]}}]",
        f"boiling.heater.centre=[{lower[0] + 0.12}, {lower[1] + 0.12}]", precision=precision,
    )


def test_single_precision_far_from_the_origin_is_warned_of():
    lower = [10000.0, -10000.0, 0.0]
    assert any("float32 positions at 1e+04 m are 4.9e-02 spacings apart" in text for text in warnings_of(far(lower, "single")))
    assert not any("float32" in text for text in warnings_of(far(lower, "mixed")))
    sound(stepped(far(lower, "single"), 20))
    s, near = sound(stepped(far(lower, "double"), 40)), sound(stepped(far([0.0, 0.0, 0.0], "double"), 40))
    assert s["boiled"] > 0 and s["temperature_mean"] == pytest.approx(near["temperature_mean"], rel=1e-3)


def test_any_integer_is_a_seed_of_64_bits():
    scenes = {seed: pot(*HOT, f"boiling.seed={seed}") for seed in (-1, 2**64 - 1, 5, 2**64 + 5, -(2**70) + 5, 2**32 + 5)}
    states = {seed: bits(stepped(scene, 40)) for seed, scene in scenes.items()}
    assert states[-1] == states[2**64 - 1]
    assert states[5] == states[2**64 + 5] == states[-(2**70) + 5]
    assert len(set(states.values())) == 3  # the high word counts


def test_seeds_survive_the_run_file():
    from melt.scene import scene_from_toml

    for seed in (-3, 2**63 + 1, 2**64 + 5):
        scene = pot(f"boiling.seed={seed}")
        assert scene_from_toml(scene.to_toml(), "again").boiling.seed % 2**64 == seed % 2**64


@pytest.mark.parametrize("start", [2**31 - 3, 2**32 - 3, 2**33 + 7])
def test_steps_beyond_32_bits_draw_on(start):
    """The high word of the step turns the key: no repetition after 2^32 sub-steps."""
    def from_step(number):
        sim = Simulation(pot(*HOT), "cpu")
        sim.do.clock.sub_step = number
        for _ in range(40):
            sim.step()
        return sim

    late, early = from_step(start), from_step(start % 2**32)
    assert sound(late)["boiled"] > 0 and late.do.clock.sub_step == start + 40
    assert (bits(late) == bits(early)) == (start < 2**32)


def test_bubbles_are_born_with_the_volume_of_their_particle():
    assert 4 * 4 / 3 * np.pi * birth_radius(D) ** 3 == pytest.approx(D**3, rel=1e-14)


# ---- condensate


@pytest.mark.parametrize("overrides", [
    [], ["solver.pbf.precision=true"], ["solver.pressure=sph", "time.n_sub_max=64"],
    ["boiling.vapour.per_burst=2", "boiling.surface_transfer=1"],
])
def test_recycled_liquid_returns_and_both_ledgers_hold(overrides):
    cold = ["boiling.latent_scale=0.001", "boiling.mass_model=recycle", "boiling.air_temperature=30"]
    sim = Simulation(pot(*HOT, *cold, *overrides), "cpu")
    lowest = 99.0
    for _ in range(150):
        sim.step()
        lowest = min(lowest, sound(sim)["temperature_min"])
        assert 0 <= sim.do.clock.ledger["released_quarters"] < 4  # the rest is too little for a particle
    s = sound(sim)
    assert s["condensed"] > 5
    assert s["liquid_particles"] == N - s["boiled"] + s["condensed"]
    each = 0.008 * (4186 * (100 - 30) + 0.001 * 2.257e6)
    assert s["condensed_heat"] == pytest.approx(each * s["condensed"], rel=1e-12)
    assert abs(s["heat_missing"]) < 1e-10 * sim.do.clock.ledger["start_heat"]
    assert 29.999 < lowest < 90  # cold when it arrives
    assert np.unique(sim.read("id")).size == sim.read("id").size
    assert set(sim.do.launches) - {"bubble_exclude"} == set(sim.prepared.stages) - {"bubble_exclude"}
    assert set(sim.state.arrays) == set(sim.prepared.fields)


def test_recycled_liquid_resumes_bit_by_bit_and_agrees_with_the_device():
    scene = pot(*HOT, "boiling.latent_scale=0", "boiling.mass_model=recycle")
    whole, again = Simulation(scene, "cpu"), Simulation(scene, "cpu")
    for _ in range(70):
        whole.step()
    again.restore(*whole.checkpoint())
    for sim in (whole, again):
        for _ in range(30):
            sim.step()
    assert whole.series()["condensed"] > 0 and whole.series() == again.series() and bits(whole) == bits(again)
    scene = pot(*AT_ONCE, "boiling.mass_model=recycle", "boiling.bubbles.capacity=4608", precision="single")
    both = Simulation(scene, "cpu", lockstep="cuda-emulated")
    both.step()
    assert sound(both)["condensed"] == N  # all boiled, burst and fell back as cold rain
    assert max(found.ratio for found in both.do.worst.values()) <= 1
