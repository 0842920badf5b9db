"""Scenes in which nothing moves: what a step reads does not depend on how far back the run began."""

import numpy as np
import pytest
from extreme_scenes import scene

from melt.simulation import Simulation


def static(**heat):
    """Own liquid of another density melts off in warm air: volumes change, and with them the surface."""
    return scene(
        fluid={"temperature": 90.0},
        solid=[{"position": [0.4, 0.4, 0.6], "size": [0.4, 0.4, 0.6], "anchor": "base", "conductivity": 0.5,
                "density": 917.0, "liquid_density": 1000.0}],
        heat={"ambient_temperature": 60.0, "conductivity": 0.5, "ambient_transfer": 1.0, **heat},
        solver={"motion": False, "melt_to": "own", "density_form": "volume"},
    )


@pytest.mark.parametrize("heat", [{}, {"volume": "current"}, {"refreeze": True}], ids=["rest", "current", "refreeze"])
def test_a_resumed_static_run_is_bit_identical(heat):
    one = Simulation(static(**heat), "cpu")
    for _ in range(5):
        one.step()
    assert one.series()["melted"] > 0
    kept = one.checkpoint()
    two = Simulation(static(**heat), "cpu")
    two.restore(*kept)
    before = one.series()["melted"]
    for k in range(10):
        one.step()
        two.step()
        for name in ("temperature", "phase", "volume", "mass"):
            assert np.array_equal(one.read(name), two.read(name)), (name, k)
    assert one.series()["melted"] > before
