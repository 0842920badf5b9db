"""What is compiled before a run is what the run then calls."""

import pytest
from numba import typeof

from melt import ahead
from melt.bind import Plain
from melt.scene import load_scene
from melt.simulation import Simulation

SCENES = {
    "ice_cube_small": ["solid.0.position=[1.5, 1.3, 1.5]"], "two_jets_small": [], "stefan_front_small": [],
    "dam_break_small": ["solver.neighbours=kdtree"],
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("precision", ("single", "mixed"))
def test_every_call_was_foreseen(name, precision, monkeypatch):
    called = set()

    def call(self, stage, arguments):
        called.add((stage.name, tuple(typeof(a) for a in arguments)))
        plain(self, stage, arguments)

    plain = Plain._call
    monkeypatch.setattr(Plain, "_call", call)
    simulation = Simulation(load_scene(name, SCENES[name]), "cpu", precision)
    for _ in range(2):
        simulation.step()
    foreseen = set(ahead.signatures(simulation.do, simulation.prepared.stages))
    assert called and called <= foreseen, called - foreseen


def test_nothing_is_compiled_for_other_backends():
    do = Simulation(load_scene("stefan_front_small"), "reference").do
    assert ahead.compile_ahead(do, ["density"]) == 0
