"""Legal scenes, drawn at random, run some steps: everything stays finite, the mass is accounted for, stops are in words."""

import re

import boiling_scenes
import extreme_scenes
import flood_scenes
import numpy as np
import pytest
import slime_scenes
from hypothesis import given, settings
from hypothesis import strategies as st
from legal_floods import floods
from legal_liquids import boiling, melting, slime
from scene_keys import in_words
from scene_runs import stepped

from melt.errors import MeltError
from melt.geometry.build import build
from melt.scene import scene_from_dict, scene_from_toml
from melt.simulation import Simulation

SYSTEMS = {"melting": melting(), "boiling": boiling(), "slime": slime(), "flood": floods()}
#: Share of the mass by which a ledger may miss: rounding of some hundred sums in the precision of the particles' masses.
ROUNDING = {"single": 1e-5, "mixed": 1e-5, "double": 1e-12}
#: What the message of a run that stops tells its reader to do.
REMEDY = re.compile(r"\b(lower|raise|set|use|loosen|add|move|fix|give|cap)\b", re.I)


def run(data, steps=2, backend="reference"):
    """Run a legal scene some steps and return the simulation, or None if it stopped in words that name a remedy."""
    scene = scene_from_dict(data)
    assert scene_from_toml(scene.to_toml()) == scene
    initial = build(scene)  # a legal scene can be built: what may stop it is its motion
    try:
        sim = Simulation(scene, backend, initial=initial)
        for _ in range(steps):
            sim.step()
            sound(sim)
    except MeltError as stop:
        in_words(stop)
        assert REMEDY.search(str(stop)), str(stop)
        return None
    return sim


def sound(sim):
    """Hold that all values of a frame and its ledgers are finite, and that no mass is made or lost."""
    for name, values in sim.frame().items():
        assert np.isfinite(values).all(), name
    s = sim.series()
    for name, value in s.items():
        assert np.isfinite(value), name
    allowed = ROUNDING[sim.prepared.precision]
    if sim.scene.kind == "flood":
        assert abs(s["volume_error"]) <= allowed
    elif sim.scene.boiling is not None:
        assert s["quarters_missing"] == 0
    else:
        made = s["mass_created"] - booked(sim.scene, s)
        assert abs(made) <= allowed * max(s["mass"] + s["mass_deleted"], 1e-300)


def booked(scene, series):
    """Return the mass that melting into the ambient liquid makes [kg]: melt keeps its volume and takes the liquid's density."""
    if not scene.solid or scene.solver.melt_to == "own":
        return 0.0
    turned = series.get("melted", 0) - series.get("frozen", 0)
    return turned * scene.particle_volume * (scene.fluid.density - scene.solid[0].density)


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_random_legal_scene_runs(system):
    @settings(max_examples=settings().max_examples if settings().max_examples > 100 else 20)
    @given(SYSTEMS[system])
    def runs(data):
        run(data)

    runs()


SPEEDS = st.tuples(*[st.floats(-0.5, 0.5)] * 3).map(list)
#: Scenes of which other tests compile the stages: what is drawn are numbers alone.
COMPILED = {
    "melting": lambda v: extreme_scenes.scene(fluid={"fill": [{"lower": [0, 0, 0], "upper": [0.8, 0.8, 0.4], "velocity": v}]}),
    "boiling": lambda v: boiling_scenes.tank((4, 4), 3, boiling={"nucleation_time": abs(v[0])}),
    "slime": lambda v: slime_scenes.slime(fluid={"fill": [slime_scenes.square((-3, -3), (6, 6), velocity=[v[0], 0, v[2]])]}),
    "flood": lambda v: flood_scenes.flood(fluid={"fill": [{"lower": [0, 0], "upper": [3, 4], "depth": 0.5, "velocity": v[:2]}]}),
}


@pytest.mark.parametrize("system", COMPILED)
def test_a_random_start_runs_compiled_and_twice_alike(system):
    @settings(max_examples=3)
    @given(SPEEDS)
    def runs(velocity):
        one, two = (stepped(COMPILED[system](velocity), 2) for _ in range(2))
        sound(one)
        for name, values in one.frame().items():
            assert np.array_equal(values, two.frame()[name]), name

    runs()
