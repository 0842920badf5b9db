"""Pots and tanks for the tests of extremes of boiling, and what they are asked."""


import numpy as np

from melt.preflight import plan
from melt.scene import load_scene, scene_from_dict
from melt.simulation import Simulation

HOT = ["fluid.temperature=99", "boiling.latent_scale=0.005", "boiling.nucleation_time=0.1"]
AT_ONCE = ["fluid.temperature=100", "boiling.latent_scale=0", "boiling.nucleation_time=0"]
N = 1152  # liquid particles of the pot
D = 0.02


def pot(*overrides, precision="double"):
    """The small kettle with other values."""
    return load_scene("kettle_small", [f"solver.precision={precision}", f"boiling.bubbles.capacity={2 * N}", *overrides])


def tank(cells, layers, head=4, boiling=None, **changes):
    """A tank of so many spacings (x, y) with liquid on its floor, 1/240 s a step; hot, heated in the middle."""
    size = [cells[0] * D, cells[1] * D]
    return scene_from_dict({
        "time": {"end": 1.0, "dt": 1 / 240, **changes.pop("time", {})},
        "domain": {"upper": [*size, (layers + head) * D], "spacing": D, **changes.pop("domain", {})},
        "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [*size, layers * D]}], "temperature": 99, **changes.pop("fluid", {})},
        "solver": {"pressure": "pbf", "precision": "double", **changes.pop("solver", {})},
        "boiling": {"latent_scale": 0, "nucleation_time": 0.05, "heater": {}, **(boiling or {})},
        **changes,
    })


def stepped(scene, steps, initial=None, precision=None):
    sim = Simulation(scene, "cpu", initial=initial, precision=precision)
    for _ in range(steps):
        sim.step()
    return sim


def warnings_of(scene):
    return [f.text for f in plan(scene).findings if f.level == "warning"]


def notes_of(scene):
    return "\n".join(f.text for f in plan(scene).findings if f.level == "note")


def sound(sim):
    """Assert what holds after any step: everything finite, mass exact in quarters, all within the walls; return the series."""
    assert all(np.isfinite(values).all() for values in sim.frame().values())
    values = sim.series()
    assert values["quarters_missing"] == 0 and values["lost_particles"] == 0
    return values


def bits(sim, names=("id", "phase", "position", "velocity", "temperature", "bubble_radius")):
    return b"".join(sim.read(n).tobytes() for n in names)
