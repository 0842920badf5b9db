"""What the step page of a flood must not do: lose water, make a NaN of a landing, let readings change the run."""

import numpy as np
import pytest
from flood_scenes import DEPTH, PLAIN, flood, stepped

from melt.errors import InputError, SceneError
from melt.geometry.build import build


def test_columns_that_fall_land_on_dry_ground_and_among_water_without_a_nan():
    """What lands has no depth of its own before the next solve; on rough ground columns land one after the other."""
    rough = {**PLAIN, "shape": "noise", "parameters": {"amplitude": 0.5, "wavelength": 2.0}}
    fill = [{"lower": [-1.0, -1.0], "upper": [1.0, 1.0], "depth": DEPTH, "velocity": [2.0, 0.0]}]
    for form in ("variational", "balanced"):
        falling = flood(
            terrain=rough, fluid={"fill": fill, "release_height": 0.5}, solver={"form": form}, time={"dt": 0.05, "n_sub_max": 200}
        )
        sim = stepped(falling, 16)
        values = sim.series()
        assert values["airborne_particles"] == 0 and abs(values["volume_error"]) < 1e-12
        assert np.isfinite(sim.read("position")).all()


def test_all_columns_fall_as_long_as_a_stone():
    """They bound the time step: none is below the ground, and none lands late by more than a 40th of the fall."""
    sim = stepped(flood(fluid={"fill": [{"depth": DEPTH}], "release_height": 1.0}, time={"dt": 0.5, "n_sub_max": 200}), 0)
    fall = (2 * 1.0 / 9.81) ** 0.5
    while sim.series()["airborne_particles"]:
        sim.step(0.01)
        assert (sim.read("position")[:, 2] >= sim.read("bed") - 0.15).all()
    assert fall * 0.9 < sim.time < fall * 1.1


def test_readings_of_gauges_are_fewer_and_all_else_is_the_same():
    def run_with(every):
        return stepped(flood(output={"gauge_every": every}, gauge=[{"name": "a", "position": [0.0, 0.0]}]), 7)

    often, seldom = run_with(1), run_with(3)
    for name in ("position", "depth"):
        assert (often.read(name) == seldom.read(name)).all()
    for name in ("sample_depth", "wet_time", "most_depth"):
        assert (often.state.read(name) == seldom.state.read(name)).all()
    assert often.state.read("wet_time").max() <= often.time + 1e-6
    assert [len(sim.readings()["time"]) for sim in (often, seldom)] == [8, 3]


def test_what_would_lose_water_is_refused():
    with pytest.raises(SceneError, match="settle"):
        flood(fluid={"fill": [{"depth": DEPTH}], "settle": 1.0}, boundary={"east": "open"})
    with pytest.raises(InputError, match="discharge of -1"):
        build(flood(edge=[{"side": "west", "discharge": {"table": [[0, -1.0], [1, 1.0]]}}]))
