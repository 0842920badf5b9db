"""Spec 7 of floods, terrain and columns: cliffs, basins, holes, single and coincident columns, thin and deep water."""

import numpy as np
import pytest
from flood_scenes import ALL_OPEN, DEPTH, PLAIN, R0, flood, from_file, raster, sound, watched, water
from scene_runs import stepped

from melt.errors import GeometryError
from melt.simulation import Simulation

CLIFF = {"shape": "cliff", "upper": [16.0, 4.0], "parameters": {"position": 6.0, "height": 10.0}}
SPILL = {"fill": [{"lower": [0.0, 0.0], "upper": [5.0, 4.0], "depth": DEPTH}]}

# ---- terrain


@pytest.mark.parametrize("control", [None, {}])
def test_over_a_cliff_of_one_cell_no_column_is_faster_than_its_fall(control):
    scene = flood(terrain=CLIFF, fluid=SPILL, **({} if control is None else {"control": control}))
    sim, fastest = Simulation(scene, "cpu"), 0.0
    for _ in range(60):
        before = sim.read("position")[:, :2].copy()
        sim.step()
        s = sound(sim)
        fastest = max(fastest, s["largest_speed"])
        moved = np.linalg.norm(sim.read("position")[:, :2] - before, axis=1).max()
        assert moved <= s["n_sub"] * 0.5 * max(0.5, R0) * (1 + 1e-12)  # half a cell, or half a spacing, at once
    assert fastest <= 1.1 * np.sqrt(2 * 9.81 * (10 + DEPTH))
    if control is None:
        assert (sim.read("position")[:, 0] > 7).any()  # it does fall


def test_a_closed_basin_fills_to_a_level_and_comes_to_rest():
    """Water poured into one half of a pit with a rough bed, which takes its energy (quadratic: as 1/t^2)."""
    pit = {"shape": "pit", "lower": [-6.0, -6.0], "upper": [6.0, 6.0], "parameters": {"depth": 2.0, "radius": 5.0}}
    pool = {"fill": [{"lower": [-3.0, -3.0], "upper": [0.0, 3.0], "stage": -0.4}], "spacing": 0.3, "reference_depth": 0.5}
    sim = stepped(flood(terrain=pit, fluid=pool, time={"dt": 0.2}, friction={"manning": 0.3}), 5)
    early = sound(sim)["kinetic_energy"]
    for _ in range(295):
        sim.step()
    s = sound(sim)
    assert s["kinetic_energy"] < 1e-3 * early
    d, b = water(sim, "depth"), water(sim, "bed")
    inside = d > 0.25 * d.max()  # columns at the rim see a void on one side
    assert inside.sum() > 50 and np.std((b + d)[inside]) <= 0.01 * d.max()


@pytest.mark.parametrize("policy", ["wall", "fill", "open"])
@pytest.mark.parametrize("hole", ["nan", "inf", "-9999"])
def test_nodes_without_elevation_are_treated_by_policy(policy, hole, tmp_path):
    bed = np.zeros((8, 16))
    bed[2:5, 9:12] = float(hole)
    path = raster(tmp_path, bed, mark=-9999)
    sim = Simulation(flood(terrain=from_file(path, nodata=policy)), "cpu")
    assert any(note.startswith("9 of 128 nodes") for note in sim.initial.notes)
    for _ in range(40):
        sim.step()
        s = sound(sim)
        x, y = water(sim, "position")[:, :2].T
        # the distance between nodes is bilinear: it rounds corners off by 0.22 cell, edges it does not move
        deep = np.min([x - 4.5, 6.0 - x, y - 1.5, 3.0 - y], axis=0)
        assert policy == "fill" or deep.max() <= 0.22 * 0.5
        straight = (np.abs(y - 2.25) < 0.25) & (policy != "fill")
        assert deep[straight].max(initial=0.0) <= 0.01 * 0.5
    assert np.abs(water(sim, "bed")).max() < 1e-12  # none of the marks is sampled
    left = s["left_edge"] > 0
    assert left == (policy == "open") and s["left_blocked"] == s["lost_particles"] == 0


@pytest.mark.parametrize("change, said", [(np.nan, "none of its 128 nodes has an elevation"), (None, "16 x 1 nodes make no surface")])
def test_a_terrain_that_is_none_is_refused(change, said, tmp_path):
    bed = np.zeros((1, 16)) if change is None else np.full((8, 16), change)
    with pytest.raises(GeometryError, match=said):
        Simulation(flood(terrain=from_file(raster(tmp_path, bed))), "cpu")


def test_oblong_cells_give_what_square_ones_give():
    """On a plane: its slope does not depend on the cells, if both spacings are taken for what they are."""
    plane = {"shape": "plane", "parameters": {"slope": 0.1, "direction": 30.0}}
    square, oblong = (stepped(flood(terrain={**plane, "cell": cell}), 10) for cell in (0.5, [0.5, 0.25]))
    assert sound(oblong)["largest_speed"] > 0.5
    # the bed beyond the nodes at the edge differs; with dx and dy mixed up columns would be 0.06 m apart
    assert np.median(np.abs(square.read("position") - oblong.read("position"))[:, :2]) < 2e-3


@pytest.mark.parametrize("maps", [False, True])
def test_a_dry_terrain_steps(maps):
    s = sound(stepped(flood(fluid={"fill": []}, output={"maps": maps}), 3))
    assert s["liquid_particles"] == s["volume"] == s["largest_depth"] == 0


# ---- few columns


def single(**sections):
    fill = [{"centre": [0.0, 0.0], "radius": 0.2, "depth": DEPTH, "velocity": [0.6, 0.0]}]
    return flood(**{"terrain": PLAIN, "fluid": {"fill": fill}} | sections)


def test_a_single_column_runs_on_at_constant_speed_with_the_depth_of_an_isolated_one():
    sim = stepped(single(time={"dt": 0.1}, solver={"kernel": "cubic"}), 20)  # the specification's figure is the cubic spline's
    assert len(sim.read("id")) == 1
    assert sim.read("velocity")[0] == pytest.approx([0.6, 0, 0], abs=1e-12)
    flood_ = sim.prepared.params["flood"]
    assert sim.read("support_radius")[0] == flood_.largest == pytest.approx(5 * 2.66 * R0)
    assert sim.read("support_factor")[0] == 1
    V = sim.read("rest_volume")[0]
    assert sim.read("depth")[0] == pytest.approx(0.0103 * V / R0**2, rel=0.01)
    assert sound(sim)["isolated_columns"] == 1
    rough = stepped(single(time={"dt": 0.1}, friction={"manning": 0.03}), 20)
    assert 0 < rough.read("velocity")[0, 0] < 0.3


def test_a_pair_of_columns_obeys_bed_and_friction():
    """Fewer than 3 neighbours: no gradient correction, flagged, finite."""
    slope = {**PLAIN, "shape": "plane", "parameters": {"slope": 0.1}}
    fill = [{"centre": [0.0, 0.0], "radius": 0.32, "depth": DEPTH}]
    sim = stepped(flood(terrain=slope, fluid={"fill": fill, "even": False}, time={"dt": 0.1}), 10)
    s = sound(sim)
    n = len(sim.read("id"))
    assert n == 2 and s["isolated_columns"] == 2 and (sim.read("support_factor") == 1).all()
    assert sim.read("velocity")[:, 0].mean() == pytest.approx(0.981 * 0.95, rel=0.01)  # v^(n-1/2)


def test_columns_at_one_place_part_in_the_same_way_every_time():
    def run():
        sim = Simulation(flood(terrain=PLAIN), "cpu")
        x = sim.state.read("position")
        x[:2, 1] = x[:2, 0]
        sim.state.set("position", x)
        pair, apart = sim.state.read("id")[:2], [0.0]
        for _ in range(6):
            sim.step()
            sound(sim)
            apart.append(np.linalg.norm(np.diff(sim.read("position")[pair, :2], axis=0)))
        assert (np.diff(apart) > 0).all()
        return sim.read("position")

    assert np.array_equal(run(), run())


# ---- thin and deep


def test_a_bore_into_water_ten_thousand_times_thinner():
    strip = {"lower": [0.0, 0.0], "upper": [20.0, 1.5]}
    fill = [{"lower": [0.0, 0.0], "upper": [4.0, 1.5], "depth": 1.0}, {"lower": [4.0, 0.0], "upper": [20.0, 1.5], "depth": 1e-4}]
    scene = flood(terrain=strip, fluid={"spacing": 0.2, "reference_depth": 1.0, "layout": "equal_area", "fill": fill})
    sim = Simulation(scene, "cpu")
    assert sim.read("depth").max() / sim.read("depth").min() > 5e3
    for _ in range(20):
        sim.step()
        sound(sim)
        assert (sim.read("depth") > 0).all()
    fast = sim.read("velocity")[:, 0] > 0.5
    front = sim.read("position")[fast, 0].max()
    assert 4 + np.sqrt(9.81) < front < 4 + 2 * np.sqrt(9.81) + 2 * 0.2  # t = 1 s: the tip of Ritter at most


def test_many_supports_at_their_limit_are_a_warning():
    spray = {"fill": [{"lower": [-40.0, -40.0], "upper": [40.0, 40.0], "depth": 0.005}]}
    told = watched(Simulation(flood(terrain=PLAIN, fluid=spray), "cpu"), 2)
    assert len(told) == 1 and "100% of the columns are at a limit" in told[0] and "solver.support_limits" in told[0]
    assert not watched(Simulation(flood(), "cpu"), 2)


# ---- leaving


def test_columns_leave_over_open_edges_and_the_ledger_knows():
    sim = stepped(flood(boundary=ALL_OPEN), 60)
    s = sound(sim)
    assert s["left_edge"] > 0.5 * 6.0 and s["volume"] + s["left_edge"] == pytest.approx(6.0, rel=1e-12)
    assert s["liquid_particles"] == (sim.read("phase") == 0).sum() < sim.initial.active


def test_walls_keep_every_column():
    s = sound(stepped(flood(), 60))
    assert s["left_edge"] == s["left_blocked"] == 0 and s["liquid_particles"] == stepped(flood(), 0).initial.active
