"""What the step page of a flood must not do: lose water, make a NaN of a landing, let readings change the run."""

import numpy as np
import pytest
from flood_scenes import DEPTH, PLAIN, flood
from scene_runs import stepped

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


def test_a_thin_column_on_a_hillside_draws_no_lake_below_it():
    """The mean of surfaces far up the slope is not the surface here: at most twice the columns' own depth."""
    hill = {"lower": [-8.0, -8.0], "upper": [8.0, 8.0], "cell": 0.25, "shape": "plane", "parameters": {"slope": 0.5}}
    fill = [{"centre": [0.0, 0.0], "radius": 0.3, "depth": 0.05}]
    sim = stepped(flood(terrain=hill, fluid={"fill": fill}, output={"maps": True}), 1)
    depths = sim.state.read("sample_depth")
    assert 0 < depths.max() <= 2 * sim.read("depth").max() * (1 + 1e-9)


def test_gauges_come_out_as_a_table(tmp_path):
    from melt import simulation
    from melt.output.gauges import as_csv

    scene = flood(gauge=[{"name": "a", "position": [1.0, 2.0]}, {"name": "b", "position": [7.0, 2.0]}], time={"end": 0.2})
    simulation.run(scene, tmp_path / "g.vtkhdf", backend="cpu")
    lines = as_csv(tmp_path / "g.vtkhdf").splitlines()
    assert lines[0].startswith("time [s],a surface [m],a depth [m],a speed [m/s],b surface [m]")
    assert len(lines) == 1 + 5 and float(lines[1].split(",")[2]) == pytest.approx(DEPTH, rel=0.1)
