"""Spec 7 of floods, failure: time steps too long, columns too fast, NaN, bad values, inflow without room, far coordinates."""

import numpy as np
import pytest
from flood_scenes import ALL_OPEN, flood, from_file, raster, sound, watched
from scene_runs import stepped

from melt.errors import InputError, MeltError, SceneError
from melt.geometry.build import build
from melt.preflight import plan
from melt.simulation import Simulation

# ---- time steps


def test_a_huge_fixed_step_is_cut_to_a_courant_number_of_0_7_and_warned_of():
    scene = flood(time={"dt": 1.0, "n_sub": 1})
    assert any("Courant number" in f.text and f.level == "warning" for f in plan(scene).findings)
    sim = Simulation(scene, "cpu")
    told = watched(sim, 4)
    assert len(told) >= 1 and told[0].startswith("time.n_sub = 1 makes sub-steps of 1 s, above a Courant number of 0.7")
    s = sound(sim)
    assert s["n_sub"] > 1
    assert s["step_over_limit"] <= 0.7 / scene.solver.cfl * (1 + 1e-9)
    start = flood_energy(Simulation(scene, "cpu"))
    assert 0.5 * start < flood_energy(sim) <= start  # 4 s of sloshing: it neither blows up nor gains


def flood_energy(sim):
    s = sim.series()
    return s["kinetic_energy"] + s["potential_energy"]


def test_enough_given_sub_steps_are_left_as_they_are():
    sim = Simulation(flood(time={"n_sub": 4}), "cpu")
    assert not watched(sim, 3) and sim.series()["n_sub"] == 4


def test_too_many_sub_steps_are_refused_in_words():
    scene = flood(time={"dt": 1.0, "n_sub_max": 2})
    assert any("time.n_sub_max is 2: the run will stop" in f.text and f.level == "warning" for f in plan(scene).findings)
    with pytest.raises(MeltError, match=r"the bound 'wave' allows sub-steps of .* time.n_sub_max is 2: lower time.dt"):
        stepped(scene, 1)


def test_a_column_faster_than_top_speed_stops_the_run_and_says_what_to_do():
    with pytest.raises(MeltError, match=r"t = .* s: a column moves at .* m/s, faster than solver.top_speed = 0.5 m/s.*\[control\]"):
        stepped(flood(solver={"top_speed": 0.5}), 20)


# ---- values


@pytest.mark.parametrize(
    ("field", "stage"), [("velocity", "flood_kick"), ("position", "flood_drift"), ("rest_volume", "none: it was so from outside")]
)
def test_a_nan_is_named_with_its_column(field, stage):
    sim = stepped(flood(), 2)
    values = sim.state.read(field)
    values[..., 7] = np.nan
    sim.state.set(field, values)
    who = int(sim.state.read("id")[7])
    with pytest.raises(MeltError, match=rf"field \w+ \(stage .*{stage}.*\) is not finite at particle {who}, position") as caught:
        sim.step()
    assert "solver.cfl" in str(caught.value) or "time.dt" in str(caught.value)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"fluid": {"spacing": 0.0}}, "fluid.spacing = 0.0 is not allowed: it must be greater than 0"),
        ({"fluid": {"spacing": -1.0}}, "fluid.spacing"),
        ({"fluid": {"spacing": float("nan")}}, "fluid.spacing"),
        ({"fluid": {"density": 0.0}}, "fluid.density"),
        ({"fluid": {"reference_depth": -0.5}}, "fluid.reference_depth"),
        ({"fluid": {"fill": [{"depth": 0.0}]}}, "fluid.fill.0.depth"),
        ({"fluid": {"fill": [{"depth": float("inf")}]}}, "fluid.fill.0.depth"),
        ({"gravity": 0.0}, "gravity"),
        ({"time": {"dt": float("nan")}}, "time.dt"),
        ({"terrain": {"cell": 0.0}}, "terrain.cell"),
        ({"solver": {"cfl": 0.8}}, "solver.cfl = 0.8 is not allowed: it must be at most 0.7"),
        ({"friction": {"manning": -0.1}}, "friction.manning"),
        ({"inflow": [{"discharge": -1.0, "centre": [1, 1], "radius": 1}]}, "inflow.0.discharge"),
        ({"inflow": [{"discharge": 1.0, "centre": [1, 1], "radius": 0}]}, "inflow.0.radius"),
        ({"rain": {"rate": float("nan")}}, "rain.rate"),
    ],
)
def test_zero_negative_and_nan_are_refused_by_name(change, said):
    with pytest.raises(SceneError) as caught:
        flood(**change)
    assert said in str(caught.value)


@pytest.mark.parametrize("name", ["rest_volume", "mass"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan])
def test_an_initial_state_without_mass_is_refused(name, value):
    scene = flood()
    initial = build(scene)
    initial.arrays[name][3] = value
    with pytest.raises(InputError, match=rf"initial state: {name}\[3\] = "):
        Simulation(scene, "cpu", initial=initial)


def test_supports_far_below_the_cells_are_a_warning():
    scene = flood(terrain={"upper": [80.0, 40.0], "cell": 5.0})
    assert any("far below the terrain's cells" in f.text and f.level == "warning" for f in plan(scene).findings)


# ---- inflow


def test_an_inflow_without_room_waits_and_is_told():
    pour = [{"discharge": 40.0, "centre": [4.0, 2.0], "radius": 1.0}]
    scene = flood(inflow=pour, fluid={"capacity": 120}, boundary=ALL_OPEN)
    assert any("the inflow will stop" in f.text for f in plan(scene).findings)
    sim = stepped(scene, 6)
    assert sim.do.notes["inflow_stopped"] == 6
    s = sound(sim)
    assert len(set(sim.read("id"))) == 120
    assert s["entered_volume"] < 40 * 0.3
    for _ in range(40):  # as columns leave, others enter
        sim.step()
    assert sound(sim)["entered_volume"] > s["entered_volume"]


def test_an_inflow_faster_than_it_spreads_is_a_warning_before_the_run():
    def told(radius, dt):
        scene = flood(inflow=[{"name": "pipe", "discharge": 40.0, "centre": [4.0, 2.0], "radius": radius}], time={"dt": dt})
        return [f.advice for f in plan(scene).findings if f.level == "warning" and "pipe" in f.text]

    assert not told(1.5, 0.05)
    (text,) = told(0.5, 1.0)
    assert "puts 50.9 m of water there at once" in text and "time.dt = " in text
    assert not told(0.5, float(text.split("time.dt = ")[1].split(",")[0]))


def test_an_inflow_keeps_its_discharge_and_gives_every_column_an_id_of_its_own():
    sim = stepped(flood(inflow=[{"discharge": 1.3, "centre": [5.0, 2.0], "radius": 1.0}]), 20)
    s, here = sound(sim), sim.read("phase") == 0
    assert abs(s["entered_volume"] - 1.3) <= sim.scene.column_volume
    assert len(set(sim.read("id")[here])) == here.sum() == s["liquid_particles"]


def test_mass_law_with_inflow_rain_infiltration_and_open_edges():
    scene = flood(
        inflow=[{"discharge": {"table": [[0, 0], [1, 3]]}, "line": [[5.0, 1.0], [5.0, 3.0]]}], rain={"rate": "20 mm/s"},
        infiltration={"rate": "5 mm/s"}, boundary={"east": "open"}, friction={"manning": 0.02},
    )
    sim = stepped(scene, 40)
    s = sound(sim)
    assert s["entered_volume"] > 1 and s["infiltrated"] > 0.1 and s["left_edge"] > 0
    total = s["volume"] + s["left_edge"] + s["left_blocked"] + s["infiltrated"] + s["dried"] - s["entered_volume"]
    assert total == pytest.approx(sim.do.clock.ledger["volume_start"], rel=1e-12)


# ---- coordinates


def test_far_from_the_origin_single_precision_gives_the_local_result(tmp_path):
    """UTM northings have half a metre of resolution in float32."""
    bed = 0.1 * np.sin(np.arange(8))[:, None] + 0.05 * np.arange(16)[None, :]

    def run(x0, y0):
        path = raster(tmp_path, bed)
        path.write_text(path.read_text().replace("xllcorner 0", f"xllcorner {x0}").replace("yllcorner 0", f"yllcorner {y0}"))
        fill = [{"lower": [x0, y0], "upper": [x0 + 3.0, y0 + 4.0], "stage": 0.5}]
        obstacle = [{"shape": "cylinder", "centre": [x0 + 5.0, y0 + 2.0], "radius": 0.6}]
        gauge = [{"position": [x0 + 4.0, y0 + 2.0]}]
        scene = flood(terrain=from_file(path), fluid={"fill": fill}, obstacle=obstacle, gauge=gauge, solver={"precision": "single"})
        sim = stepped(scene, 10)
        return sim, sim.read("position")[:, :2] + sim.initial.terrain.origin - [x0, y0], sim.do.clock.readings

    (_, near, near_read), (sim, far, far_read) = run(0, 0), run(382249, 6354265)
    assert sim.state.get("position").dtype == np.float32 and np.abs(sim.read("position")).max() < 10
    assert np.array_equal(near, far)
    assert near_read == far_read
    assert sim.initial.terrain.world(sim.read("position")[:, :2].T).min(axis=1) == pytest.approx([382249, 6354265], abs=1)
