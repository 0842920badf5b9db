"""Runs of incompressible liquids: repeatability, resumption, two backends in step, ledgers, inflow, moving bodies."""

import numba
import numpy as np
import pytest
from scene_runs import datasets, stepped
from slime_scenes import RHO, D, carriers, liquid, pool, slime, sound, square

from melt import simulation
from melt.output.run_reader import open_run
from melt.physics.phases import DRIVEN, WALL
from melt.scene import load_scene
from melt.simulation import Simulation

LOW = ["inflow.0.position=[0,0,0.012]", "inflow.0.speed=0.4"]  # liquid reaches the plate within 20 steps


def coil(*overrides):
    return load_scene("honey_coil_small", [*LOW, *overrides])


CARRIED = ("id", "position", "velocity", "density_impulse", "viscous_pressure", "poisson_pressure", "temperature")


def bits(sim):
    names = [n for n in CARRIED if n in sim.state]
    apic = carriers(sim, "apic_position", "apic_velocity", "apic_affine", "apic_mass") if sim.prepared.need.apic else []
    return [sim.read(n) for n in names] + apic


def same(a, b):
    return all(np.array_equal(x, y) for x, y in zip(bits(a), bits(b), strict=True))


# ---- shipped scenes, shortened

SHIPPED = {
    "couette": 0.005, "poiseuille": 0.005, "taylor_green": 0.02, "rotating_square": 0.03, "hydrostatic": 0.02, "oscillating_drop": 0.03,
    "dam_break_dfsph": 0.006, "moving_square": 0.02, "honey_coil_small": 0.02, "slime_drop": 0.004, "warm_honey": 0.004,
}  # fmt: skip


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_scene_begins_as_planned(name, tmp_path):
    scene, path = load_scene(name), tmp_path / "run.vtkhdf"
    done = simulation.run(scene, path, backend="cpu", until=SHIPPED[name])
    sim = done.simulation
    s = sim.series()
    assert sim.time == pytest.approx(SHIPPED[name]) and all(np.isfinite(v) for v in s.values())
    assert abs(s["mass_created"]) < 1e-5 * max(s["mass"], 1e-9) and s.get("unconverged", 0) == s.get("retries", 0) == 0
    assert set(sim.do.launches) <= set(sim.prepared.stages)
    with open_run(path) as run:
        assert len(run) >= 2 and (run.frame(-1)["phase"] == WALL).any() == (scene.output.walls and sim.initial.counts["wall"] > 0)


# ---- repeatability


@pytest.mark.parametrize("overrides", [[], ["solver.dfsph.semi_lagrangian=true"]])
def test_threads_change_neither_a_bit_nor_an_iteration(overrides):
    def run(threads):
        numba.set_num_threads(threads)
        sim, counts = Simulation(coil(*overrides), "cpu"), []
        for _ in range(20):
            sim.step()
            counts.append({k: v for k, v in sim.do.notes.items() if k.endswith("_iterations") or k == "ghosts"})
        return sim, counts

    available, most = numba.get_num_threads(), numba.config.NUMBA_NUM_THREADS
    if most < 2:
        pytest.skip("one thread only")
    try:
        alone, iterations = run(1)
        for threads in range(2, min(most, 3) + 1):
            sim, counts = run(threads)
            assert same(alone, sim) and counts == iterations
    finally:
        numba.set_num_threads(available)
    assert sum(c["viscous_iterations"] for c in iterations) > 100 and (alone.read("phase") == 0).sum() > 50


RESUMED = {
    "coil": lambda: coil("time.end=0.04", "time.output_every=0.01"),
    "heated": lambda: load_scene("warm_honey", ["domain.spacing=2.5 mm", "time.end=0.02", "time.output_every=0.004"]),
    "retried": lambda: pool(
        solver={"pressure": "dfsph", "apic": None, "ghosts": None, "dfsph": {"max_iterations": 12, "retries": 4}},
        time={"dt": 0.02, "end": 0.2, "output_every": 0.04},
    ),
    "moved": lambda: pool(
        obstacle=[{"lower": [-0.4, -1, 0.3], "upper": [-0.2, 1, 0.5], "motion": [[0, 0.3, 0, 0], [0.1, 0.5, 0, 0.1]]}],
        viscosity={"mu": 50}, time={"end": 0.12, "output_every": 0.04},
    ),
}


@pytest.mark.parametrize("case", RESUMED)
def test_a_resumed_run_is_the_whole_one_bit_by_bit(case, tmp_path):
    scene = RESUMED[case]()
    whole = simulation.run(scene, tmp_path / "whole.vtkhdf", backend="cpu").simulation
    part = simulation.run(scene, tmp_path / "part.vtkhdf", backend="cpu", until=scene.time.end / 2).simulation
    assert part.do.clock.step < whole.do.clock.step
    again = simulation.resume(tmp_path / "part.vtkhdf").simulation
    assert same(whole, again) and whole.do.clock.apic == again.do.clock.apic
    a, b = datasets(tmp_path / "whole.vtkhdf"), datasets(tmp_path / "part.vtkhdf")
    n = a["VTKHDF/NumberOfPoints"][-1]
    for name in ("Points", "PointData/velocity", "PointData/id", "PointData/pressure"):
        assert np.array_equal(a[f"VTKHDF/{name}"][-n:], b[f"VTKHDF/{name}"][-n:]), name
    for name in ("mass", "kinetic_energy", "momentum_x", "density_iterations"):
        assert a[f"melt/series/{name}"][-1] == b[f"melt/series/{name}"][-1], name
    if case == "retried":
        assert a["melt/series/retries"].max() > 0


# ---- two backends


@pytest.mark.parametrize("precision", ["mixed", "double"])
def test_cpu_and_emulated_cuda_agree_on_a_live_coil(precision):
    sim = Simulation(coil(f"solver.precision={precision}"), "cpu", lockstep="cuda-emulated")
    for _ in range(16):
        sim.step()
    worst = sim.do.worst
    assert max(found.ratio for found in worst.values()) <= 1
    wanted = {"apic_to_nodes", "nodes_to_apic", "ghost_candidates", "ghost_complete", "viscous_apply", "poisson_apply", "pressure_update"}
    assert wanted <= {stage for stage, _ in worst}


def test_cpu_and_emulated_cuda_agree_on_live_slime():
    """Elastic, with arrivals and a moving body."""
    scene = pool(
        elastic={}, viscosity={"mu": 20, "index": 0.8}, solver={"dfsph": {"semi_lagrangian": True}},
        obstacle=[{"lower": [-0.4, -1, 0.3], "upper": [-0.2, 1, 0.5], "spin": [0, 2.0, 0]}],
    )
    sim = Simulation(scene, "cpu", lockstep="cuda-emulated")
    for _ in range(2):
        sim.step()
    assert max(found.ratio for found in sim.do.worst.values()) <= 1
    assert {"apic_strain", "elastic_force", "drive", "shear_rate", "restore_motion"} <= {stage for stage, _ in sim.do.worst}


# ---- ledgers


EXACT = {"mu": 50, "tolerance": 1e-13}  # momentum of the viscous solve is kept to its residual, all else to rounding


@pytest.mark.parametrize("sections", [{}, {"viscosity": EXACT}, {"viscosity": EXACT, "elastic": {}},
                                      {"solver": {"dfsph": {"semi_lagrangian": True}}}, {"solver": {"apic": None}}])
def test_without_walls_mass_and_momentum_stay(sections):
    moving = {"fill": [square((-3, -3), (6, 6), velocity=[0.2, 0, -0.1])], "flow": {"kind": "rotation", "rate": 1.0}}
    sim = Simulation(slime(fluid=moving, **sections), "cpu")
    start = sim.series()
    for _ in range(20):
        sim.step()
        s = sound(sim)
        scale = s["mass"] * s["largest_speed"]
        assert s["mass"] == pytest.approx(start["mass"], rel=1e-13)
        for axis in "xz":
            assert s[f"momentum_{axis}"] == pytest.approx(start[f"momentum_{axis}"], abs=1e-12 * scale)


def angular_momentum(sim):
    """About y, of the nodes."""
    m, x, v = liquid(sim, "mass"), liquid(sim, "position"), liquid(sim, "velocity")
    return float((m * (x[:, 2] * v[:, 0] - x[:, 0] * v[:, 2])).sum())


def test_transfers_keep_angular_momentum():
    """To the nodes and back, without forces and motion (x p of a rigid turn): a step of next to no time."""
    turning = {"flow": {"kind": "rotation", "rate": 1.0}}
    sim = Simulation(slime(fluid=turning, time={"dt": 1e-9}, solver={"pressure": "dfsph", "ghosts": None}), "cpu")
    sim.step()
    first = angular_momentum(sim)
    for _ in range(10):
        sim.step()
    assert angular_momentum(sim) == pytest.approx(first, rel=1e-6)


def test_viscous_forces_keep_angular_momentum_of_nodes():
    alone = {"apic": None, "ghosts": None, "pressure": "dfsph"}
    flow = {"flow": {"kind": "taylor_green", "rate": 2.0, "length": 0.6, "centre": [0.13, 0, 0.05]}}
    sim = Simulation(slime(fluid=flow, viscosity={"mu": 100, "stokes": "split", "tolerance": 1e-13}, solver=alone), "cpu")
    first = angular_momentum(sim)
    for _ in range(10):
        sim.step()
        m = liquid(sim, "mass")
        assert angular_momentum(sim) == pytest.approx(first, abs=1e-9 * m.sum() * 0.3)


def test_ice_melts_in_an_incompressible_bath_and_ledgers_close():
    scene = load_scene("ice_cube_small", ["solver.pressure=dfsph", "solid.0.position=[1.5, 1.3, 1.4]", "time.end=1"])
    sim = Simulation(scene, "cpu")
    start = sim.series()
    for _ in range(60):
        sim.step()
    s = sim.series()
    assert all(np.isfinite(values).all() for values in sim.frame().values())
    assert s["melted_fraction"] > 0.1
    assert s["mass"] - s["mass_created"] == pytest.approx(start["mass"], rel=1e-6)
    kept = s["thermal_energy"] + s.get("latent_energy", 0.0) - s.get("energy_in", 0.0)
    assert kept == pytest.approx(start["thermal_energy"], abs=1e-4 * abs(start["thermal_energy"]))
    assert s["density_error_mean"] < 1e-3


def test_solids_and_liquid_push_each_other_alike():
    scene = load_scene("ice_cube_small", [
        "solver.pressure=dfsph", "solid.0.position=[1.5, 1.3, 1.0]", "domain.gravity=[0,0,0]", "domain.walls.sides=['none']",
        "solid.0.velocity=[0,0,-0.5]", "solver.precision=double",
    ])  # fmt: skip
    sim = Simulation(scene, "cpu")
    start = sim.series()
    for _ in range(10):
        sim.step()
    s = sim.series()
    scale = s["mass"] * max(s["largest_speed"], 0.5)
    for axis in "xyz":
        assert s[f"momentum_{axis}"] == pytest.approx(start[f"momentum_{axis}"], abs=1e-10 * scale)


def test_warm_honey_is_thinner_and_heat_is_kept():
    scene = load_scene("warm_honey", ["domain.spacing=2.5 mm", "heat.heater=[]"])
    sim = Simulation(scene, "cpu")
    start = sim.series()["thermal_energy"]
    for _ in range(40):
        sim.step()
    T, mu, x = (liquid(sim, n) for n in ("temperature", "viscosity", "position"))
    assert mu == pytest.approx(60 * np.exp(-0.1 * (T - 15)), rel=1e-4)
    cold, warm = (np.ptp(x[side, 0]) for side in (x[:, 0] < 0, x[:, 0] > 0))
    assert warm > cold
    assert sim.series()["thermal_energy"] == pytest.approx(start, rel=1e-5)


# ---- inflow and moving bodies


@pytest.mark.parametrize("solver", [{}, {"apic": None}])
def test_an_inflow_brings_what_its_nozzle_says(solver):
    nozzle = {"position": [0, 0, 0.9], "direction": [0, 0, -1], "radius": 0.15, "speed": 1.5, "layers": 30, "hold": 2}
    sim = stepped(slime(fluid={"fill": []}, inflow=[nozzle], viscosity={"mu": 200}, solver=solver), 80)
    s = sound(sim)
    across = sim.initial.nozzles[0].count * D
    assert s["mass"] == pytest.approx(RHO * across * 1.5 * 0.8, abs=1.5 * RHO * across * D)  # in 0.8 s, a layer more or less
    held = liquid(sim, "held") == 1
    assert held.any() and liquid(sim, "velocity")[held] == pytest.approx(np.broadcast_to([0, 0, -1.5], (held.sum(), 3)), abs=1e-9)
    assert liquid(sim, "velocity")[:, 2].mean() == pytest.approx(-1.5, rel=0.05)  # nothing pulls


BODY = {"lower": [-0.4, -1, 0.3], "upper": [-0.2, 1, 0.5]}


@pytest.mark.parametrize(("motion", "shift"), [
    ({"velocity": [0.5, 0, 0.1]}, [0.1, 0, 0.02]),
    ({"motion": [[0, 0, 0, 0], [0.1, 1.0, 0, 0], [0.3, 1.0, 0, 0]]}, [0.05 + 0.1, 0, 0]),
])
def test_a_moving_body_goes_where_it_should(motion, shift):
    sim = Simulation(pool(obstacle=[BODY | motion], viscosity={"mu": 10}), "cpu")
    driven = sim.read("phase") == DRIVEN
    before = sim.read("position")[driven]
    for _ in range(20):
        sim.step()
    sound(sim)
    assert sim.read("position")[driven] - before == pytest.approx(np.broadcast_to(shift, before.shape), abs=1e-12)


def test_a_spinning_body_turns_about_its_centre():
    """Chords, not arcs: the radius grows by half the square of the angle of a step."""
    sim = Simulation(pool(obstacle=[BODY | {"spin": [0, 2.0, 0]}], viscosity={"mu": 10}, time={"dt": 0.001}), "cpu")
    driven = sim.read("phase") == DRIVEN
    before = sim.read("position")[driven] - [-0.3, 0, 0.4]
    for _ in range(100):
        sim.step()
    after = sim.read("position")[driven] - [-0.3, 0, 0.4]
    c, s = np.cos(0.2), np.sin(0.2)
    turned = np.stack([c * before[:, 0] + s * before[:, 2], before[:, 1], -s * before[:, 0] + c * before[:, 2]], axis=1)
    assert np.abs(after - turned).max() < 3e-4 * D * 10


@pytest.mark.parametrize("change", ["solver.apic=true", "fluid.jitter=0.05"])
def test_a_start_that_is_moved_apart_is_in_the_plan(change):
    """Also where the steps have no density solve: its arrays would have no length, and be written beyond their end."""
    sim = Simulation(load_scene("hydrostatic", ["solver.pressure=isph", change]), "cpu")
    assert {"pressure_update", "density_source"} <= set(sim.do.launches) <= set(sim.prepared.stages)
    assert {"compression_source", "density_impulse", "pressure_error", "pressure_last"} <= set(sim.prepared.fields)
