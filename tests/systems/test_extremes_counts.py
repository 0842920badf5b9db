"""Spec 6: no particle, one particle, coincident particles, crowds, particles far away."""

import numpy as np
import pytest
from extreme_scenes import BASE, DX, NO_LIQUID, OPEN, WEIGHTLESS, all_finite, box, fill, merged, scene
from scene_runs import stepped

from melt import simulation
from melt.diagnostics import coincident
from melt.errors import MeltError
from melt.geometry.build import build
from melt.output.run_reader import open_run
from melt.output.surface_mesh import reconstruct
from melt.preflight import plan
from melt.scene import scene_from_dict
from melt.simulation import Simulation

ONE_LIQUID = {"fluid": fill([1, 1, 3], [1, 1, 1]), "solid": []}
ONE_SOLID = {"fluid": NO_LIQUID, "solid": [box([1, 1, 3], [1, 1, 1], temperature=-10.0)]}
ONE_EACH = {"fluid": fill([1, 1, 0], [1, 1, 1]), "solid": ONE_SOLID["solid"]}
NOTHING = {"fluid": NO_LIQUID, "solid": []}
CASES = {
    "one liquid": {**ONE_LIQUID},
    "one solid": {**ONE_SOLID},
    "one of each": {**ONE_EACH},
    "no liquid": {"fluid": NO_LIQUID},
    "no solid": {"solid": []},
    "walls only": {**NOTHING},
    "nothing": {**NOTHING, "domain": OPEN},
    "nothing, without heat": {**NOTHING, "domain": OPEN, "heat": None},
    "nothing, at rest": {**NOTHING, "domain": OPEN, "solver": {"motion": False}},
}


@pytest.mark.parametrize("case", CASES)
def test_few_particles_or_none_run_to_a_whole_file_that_resumes(case, tmp_path):
    import vtk

    small, path = scene(**CASES[case]), tmp_path / "run.vtkhdf"
    sim = simulation.run(small, path, backend="cpu", until=0.03).simulation
    assert all_finite(sim)
    count = int((sim.initial["phase"] < 2).sum())
    assert simulation.resume(path).simulation.do.clock.step == 10
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 6
    reader.SetStep(5)
    reader.Update()
    assert reader.GetOutputDataObject(0).GetNumberOfPoints() == count
    with open_run(path) as run:
        assert run.counts.tolist() == [count] * 6
        assert run.series["liquid_particles"].tolist() == [int((sim.initial["phase"] == 0).sum())] * 6
        assert run.series["mass"][-1] == pytest.approx(sim.initial["mass"][sim.initial["phase"] < 2].sum())
    lines = plan(small).lines()
    assert any("particles:" in line for line in lines)


def test_the_surface_of_nothing_is_an_empty_mesh():
    sim = stepped(scene(**NOTHING, domain=OPEN), 2)
    frame = sim.frame()
    assert frame["position"].shape == (0, 3) and frame["temperature"].shape == (0,)
    mesh = reconstruct(frame["position"], frame["temperature"], DX)
    assert mesh.vertices.shape == (0, 3) and len(mesh.faces) == 0 and len(mesh.temperature) == 0


@pytest.mark.parametrize("sections", [ONE_LIQUID, ONE_SOLID], ids=["liquid", "solid"])
@pytest.mark.parametrize("n_sub", [1, 3])
def test_one_particle_falls_freely(sections, n_sub):
    """Leap-frog with a half kick at the start is exact for constant acceleration."""
    falling = scene(**sections, domain=OPEN, time={"n_sub": n_sub}, solver={"precision": "double"})
    sim = Simulation(falling, "cpu")
    start = sim.read("position")[0].copy()
    for step in range(1, 41):
        sim.step()
        t = step * 0.005
        assert sim.read("position")[0] == pytest.approx(start - [0, 0, 0.5 * 9.81 * t**2], abs=1e-13)
    v = sim.read("velocity")[0, 2]  # at t - dts/2
    assert v == pytest.approx(-9.81 * (t - 0.5 * 0.005 / n_sub), abs=1e-12)
    assert abs(sim.read("velocity")[0, :2]).max() == 0


def test_one_liquid_particle_has_its_own_density_and_no_pressure():
    sim = stepped(scene(**ONE_LIQUID, domain=OPEN), 2)
    own = 8 / (np.pi * 0.5**3)  # cubic W(0)
    assert sim.read("density")[0] == pytest.approx(8.0 * own, rel=1e-6)  # m W(0) < rho_0
    assert sim.read("density")[0] < 1000 and sim.read("pressure")[0] == 0


def test_one_solid_particle_spins_by_no_goal_and_melts():
    hot = [box([1, 1, 3], [1, 1, 1], temperature=5.0)]
    sim = stepped(scene(fluid=NO_LIQUID, solid=hot, domain=OPEN), 3)
    assert sim.series()["solid_particles"] == 0 and sim.series()["melted_fraction"] == 1
    assert all_finite(sim)


@pytest.mark.parametrize("search", ["grid", "kdtree"])
def test_coincident_particles_are_kept_counted_and_finite(search):
    crowded = scene(solver={"neighbours": search})
    initial = build(crowded)
    initial.arrays["position"][:, 1] = initial.arrays["position"][:, 0]
    assert any("closer than 0.9 spacings" in f.text for f in plan(crowded, initial=initial).findings)
    sim = Simulation(crowded, "cpu", initial=initial)
    assert sim.series()["coincident_particles"] == 2
    for _ in range(5):
        sim.step()
    assert all_finite(sim)
    x, T = sim.read("position"), sim.read("temperature")
    assert len(x) == len(initial["id"])  # both are kept
    # nothing separates them: the gradient at r = 0 is 0, and all else is the same
    assert np.array_equal(x[0], x[1]) and sim.series()["coincident_particles"] == 2
    assert -10 <= T.min() and T.max() <= 40


def test_coincident_particles_are_counted_by_place():
    rng = np.random.default_rng(3)
    x = rng.normal(size=(3, 1000))
    everyone = np.ones(1000, bool)
    assert coincident(x, everyone, everyone) == 0
    x[:, [10, 500, 501]] = x[:, [3]]
    x[:, 600] = [0.0, -0.0, 1.0]
    x[:, 601] = [-0.0, 0.0, 1.0]
    x[0, 7] = x[0, 8]  # one coordinate alone says nothing
    assert coincident(x, everyone, everyone) == 6
    solid = np.arange(1000) < 500  # counted: liquids and solids; a wall may be the other one
    assert coincident(x, solid, everyone) == 2
    active = np.arange(1000) != 3
    assert coincident(x, everyone, active & (np.arange(1000) != 10)) == 4


@pytest.mark.parametrize("search", ["grid", "kdtree"])
def test_lists_of_a_crowd_grow_and_lose_nobody(search):
    """64 particles at one point and lists for 8: nothing is cut off."""
    crowd = scene(**{**NOTHING, "fluid": fill([0, 0, 0], [4, 4, 4])}, domain=WEIGHTLESS,
                  solver={"neighbours": search, "max_neighbours": 8}, watch={"density_error": "off"})  # fmt: skip
    initial = build(crowd)
    initial.arrays["position"][:] = 0.4
    sim = Simulation(crowd, "cpu", initial=initial)
    sim.step()
    assert sim.series()["neighbours_max"] == 63 <= sim.state.sizes["neighbour"]
    near = np.sort(sim.state.read("neighbour_index")[:, :63], axis=1)
    assert all(np.array_equal(near[i], np.delete(np.arange(64), i)) for i in range(64))
    assert sim.read("density") == pytest.approx(np.full(64, 64 * 8.0 * 8 / (np.pi * 0.5**3)), rel=1e-5)
    assert (sim.read("position") == 0.4).all()


def test_a_crowd_that_bursts_stops_the_run_in_words():
    tight = scene(watch={"speed": "off", "density_error": "off"})  # or they would stop it before
    initial = build(tight)
    liquid = initial["phase"] == 0
    initial.arrays["position"][:, liquid] = np.array([[0.4], [0.4], [0.3]])
    sim = Simulation(tight, "cpu", initial=initial)
    with pytest.raises(MeltError, match="time step: at t = .*largest speed"):
        for _ in range(20):
            sim.step()


@pytest.mark.parametrize("search", ["grid", "kdtree"])
@pytest.mark.parametrize("precision", ["single", "mixed"])
def test_a_particle_a_million_kilometres_away_costs_no_memory(search, precision):
    far = scene(solver={"neighbours": search, "precision": precision}, fluid={"sound_speed": 30.0})
    initial = build(far)
    initial.arrays["position"][:, 0] = 1e9
    sim, same = Simulation(far, "cpu", initial=initial), Simulation(far, "cpu")
    assert sim.state.nbytes == same.state.nbytes
    for _ in range(3):
        sim.step()
    assert all_finite(sim)
    assert sim.series()["lost_particles"] == 1
    assert sim.read("density")[0] < 200  # alone


@pytest.mark.parametrize(("leave", "left"), [("keep", 32), ("delete", 0)])
def test_particles_that_fall_out_of_the_domain_are_counted_and_kept_or_deleted(leave, left, tmp_path):
    falling = scene(solid=[], domain={**OPEN, "leave": leave}, time={"end": 1.0, "output_every": 0.5})
    sim = simulation.run(falling, tmp_path / "run.vtkhdf", backend="cpu").simulation
    values = sim.series()
    assert values["lost_particles"] == 32
    assert values["liquid_particles"] == left
    with open_run(tmp_path / "run.vtkhdf") as run:
        assert run.counts.tolist() == [32, left if leave == "keep" else run.counts[1], left]
        assert run.series["lost_particles"].tolist()[::2] == [0, 32]


def test_a_solid_that_leaves_keeps_its_shape():
    falling = scene_from_dict(
        merged(BASE, {"fluid": NO_LIQUID, "heat": None, "domain": {**OPEN, "leave": "delete"}})
    )
    sim = stepped(falling, 200)
    x = sim.read("position")
    assert len(x) == 8 and x[:, 2].max() < -2
    assert np.ptp(x, axis=0) == pytest.approx([DX] * 3, abs=1e-5)
    assert sim.series()["lost_particles"] == 8


def test_an_inflow_stops_when_every_slot_is_in_use_and_says_so(monkeypatch):
    jet = {"position": [0.4, 0.4, 1.0], "direction": [0, 0, -1], "radius": 0.2, "speed": 2.0, "layers": 4}
    pouring = scene(**NOTHING, inflow=[jet], time={"end": 0.6})

    def too_few_slots(scene):
        initial = build(scene)
        n = initial["id"].size
        for name, values in initial.arrays.items():
            if values.ndim and values.shape[-1] == n:
                initial.arrays[name] = np.ascontiguousarray(values[..., : n - 7])
        return initial

    monkeypatch.setattr(simulation, "build", too_few_slots)
    said = []
    sim = simulation.run(
        pouring, backend="cpu", progress=lambda event, message="", **_: said.append(message)
    ).simulation
    stops = [text for text in said if "inflow stopped" in text]
    assert len(stops) == 1 and "t = " in stops[0]
    assert sim.series()["liquid_particles"] == 10  # two whole layers of 5 of the 13 slots
    assert all_finite(sim)


def test_no_layer_of_an_inflow_is_lost_where_slots_suffice():
    jet = {"position": [0.4, 0.4, 1.0], "direction": [0, 0, -1], "radius": 0.2, "speed": 2.0, "layers": 4}
    sim = stepped(scene(**NOTHING, inflow=[jet]), 120)
    assert sim.series()["liquid_particles"] == 20 and "inflow_stopped" not in sim.do.notes
