"""A flood as a whole: resumption, threads, two backends in step, and what may not matter (order, place, direction)."""

import os
import subprocess
import sys

import numba
import numpy as np
import pytest
from flood_scenes import R0, flood, sound
from scene_runs import datasets, stepped

from melt import simulation
from melt.geometry.build import build
from melt.scene import scene_from_toml
from melt.simulation import Simulation

EVERYTHING = dict(
    terrain={"shape": "noise", "upper": [8.0, 6.0], "parameters": {"amplitude": 0.3, "wavelength": 3.0, "seed": 2}},
    fluid={"fill": [{"lower": [0.0, 0.0], "upper": [3.0, 6.0], "stage": 0.5}]},
    inflow=[{"discharge": {"table": [[0, 1], [1, 3]]}, "centre": [6.0, 4.0], "radius": 1.0}],
    boundary={"east": "open"}, obstacle=[{"shape": "cylinder", "centre": [4.0, 2.0], "radius": 0.6}], friction={"manning": 0.03},
    edge=[{"side": "south", "discharge": {"table": [[0, 0.2], [1, 0.6]]}}],
    rain={"rate": "5 mm/s"}, infiltration={"rate": "1 mm/s"}, control={}, gauge=[{"position": [3.5, 4.0]}, {"position": [5.5, 2.0]}],
    output={"maps": True, "raster": "none"}, time={"end": 1.0, "dt": 0.05, "output_every": 0.1, "n_sub_max": 100},
)


def test_a_resumed_flood_is_the_whole_one_bit_by_bit(tmp_path):
    scene = flood(**EVERYTHING)
    assert scene_from_toml(scene.to_toml()).to_toml() == scene.to_toml()
    Simulation(scene, "cpu")  # compiled: both runs load
    simulation.run(scene, tmp_path / "whole.vtkhdf", backend="cpu")
    simulation.run(scene, tmp_path / "part.vtkhdf", backend="cpu", until=0.45)
    done = simulation.resume(tmp_path / "part.vtkhdf")
    sound(done.simulation)
    whole, part = datasets(tmp_path / "whole.vtkhdf"), datasets(tmp_path / "part.vtkhdf")
    assert whole["melt/gauges/surface"].shape == (21, 2) and {f"melt/maps/{m}" for m in ("largest_depth", "arrival_time")} <= set(whole)
    # the part has a frame at its own end
    last = np.flatnonzero(~np.isin(part["VTKHDF/Steps/Values"], whole["VTKHDF/Steps/Values"]))
    assert part["VTKHDF/Steps/Values"][last] == pytest.approx([0.45])
    for name in whole:
        if name.startswith(("melt/maps", "melt/gauges")):
            assert np.array_equal(whole[name], part[name], equal_nan=True), name
    for name in ("position", "velocity", "depth", "id", "support_radius"):
        data = "Points" if name == "position" else f"PointData/{name}"
        n = whole["VTKHDF/NumberOfPoints"][-1]
        assert np.array_equal(whole[f"VTKHDF/{data}"][-n:], part[f"VTKHDF/{data}"][-n:]), name
    for name in ("volume", "entered_volume", "left_edge", "infiltrated", "kinetic_energy"):
        assert whole[f"melt/series/{name}"][-1] == part[f"melt/series/{name}"][-1], name


def test_one_and_two_threads_give_the_same_bits():
    def final(threads):
        numba.set_num_threads(threads)
        sim = stepped(flood(**EVERYTHING), 12)
        return [sim.read(name) for name in ("id", "position", "velocity", "depth", "most_depth")] + [np.array(list(sim.series().values()))]

    available = numba.get_num_threads()
    if numba.config.NUMBA_NUM_THREADS < 2:
        pytest.skip("one thread only")
    try:
        Simulation(flood(**EVERYTHING), "cpu")
        for one, two in zip(final(1), final(2)):
            assert np.array_equal(one, two)
    finally:
        numba.set_num_threads(available)


@pytest.mark.parametrize("change", [{}, {"solver": {"form": "balanced"}}, {"solver": {"form": "symmetric", "bed": "constrained"}}])
def test_cpu_and_emulated_cuda_agree_on_a_live_flood(change):
    pour = [{"discharge": 8.0, "centre": [6.0, 4.0], "radius": 1.0}]
    small = {"spacing": 0.6, "fill": EVERYTHING["fluid"]["fill"]}
    sim = Simulation(flood(**EVERYTHING | {"fluid": small, "inflow": pour} | change), "cpu", lockstep="cuda-emulated")
    for _ in range(2):
        sim.step()
    worst = sim.do.worst
    assert max(found.ratio for found in worst.values()) <= 1
    force = {"balanced_force"} if change.get("solver", {}).get("form") == "balanced" else {"flood_force", "wall_force"}
    assert {"flood_depth", "control_brake", "flood_drag", "enter", "infiltrate", "flood_sample", *force} <= {stage for stage, _ in worst}


# ---- what may not matter

BUMP = {"shape": "smooth_bump", "lower": [-4.0, -4.0], "upper": [4.0, 4.0], "cell": 0.5,
        "parameters": {"height": 0.3, "width": 2.5, "centre": [0.5, 0.0], "dimension": 2}}  # fmt: skip


def _turned(x, quarters):
    for _ in range(quarters):
        x = np.stack([-x[1], x[0], *x[2:]])
    return x


def run_turned(quarters, order=None, shift=(0.0, 0.0), walls=False):
    """Run water over a bump, all of it turned about the origin, in another order, or moved; return places turned back."""
    centre = np.array(_turned(np.array([0.5, 0.0]), quarters)) + shift
    low = np.array([-4.0, -4.0]) + shift
    bed = {**BUMP, "lower": low.tolist(), "upper": (low + 8).tolist(), "parameters": {**BUMP["parameters"], "centre": centre.tolist()}}
    pool = {"lower": low.tolist(), "upper": (low + 8).tolist(), "stage": 0.5}
    scene = flood(terrain=bed, fluid={"fill": [pool]}, boundary={"columns": walls})
    plain = build(flood(terrain=BUMP, fluid={"fill": [{"stage": 0.5}]}))
    initial = build(scene)
    n = plain["id"].size
    for name in ("position", "position_before", "velocity"):
        moved = _turned(plain[name], quarters)
        initial.arrays[name] = moved + (0 if name == "velocity" else np.array([*shift, 0.0])[:, None])
    for name in ("rest_volume", "mass", "depth", "support_radius", "bed", "id", "phase"):
        initial.arrays[name] = plain[name].copy()
    push = np.zeros((3, n))
    push[0], push[1] = 0.8 * np.sin(plain["position"][1]), 0.3
    initial.arrays["velocity"] = _turned(push, quarters)
    vectors, scalars = ("position", "position_before", "velocity"), ("rest_volume", "mass", "depth", "support_radius", "bed", "id", "phase")
    for name in (*vectors, *scalars, "brake"):
        if order is not None:
            initial.arrays[name] = initial.arrays[name][..., order]
    sim = Simulation(scene, "cpu", initial=initial)
    for _ in range(10):
        sim.step()
    sound(sim)
    x = sim.read("position").T - np.array([*shift, 0.0])[:, None]
    return _turned(x, (4 - quarters) % 4)


@pytest.fixture(scope="module")
def straight():
    return run_turned(0)


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_a_turn_by_a_right_angle_turns_the_result(straight, quarters):
    assert np.abs(run_turned(quarters) - straight).max() < 1e-9


def test_walls_turn_with_the_result_but_for_how_their_points_are_placed():
    """Areas of boundary particles are iterated to a tolerance, in the order of their cells."""
    assert np.abs(run_turned(1, walls=True) - run_turned(0, walls=True)).max() < 1e-3 * R0


def test_the_order_of_columns_does_not_matter(straight):
    order = np.random.default_rng(3).permutation(straight.shape[1])
    assert np.abs(run_turned(0, order) - straight).max() < 1e-9


def test_a_shift_of_everything_shifts_the_result(straight):
    assert np.abs(run_turned(0, shift=(13.0, -7.5)) - straight).max() < 1e-9


def test_a_run_in_another_process_is_the_same(tmp_path):
    """Hash seeds, addresses and clocks differ between processes."""
    code = (
        "import sys, hashlib; sys.path[:0] = sys.argv[1:]; from test_flood_run import EVERYTHING; "
        "from flood_scenes import flood; from scene_runs import stepped; "
        "sim = stepped(flood(**EVERYTHING), 5); bits = b''.join(sim.read(n).tobytes() for n in ('id', 'position', 'depth')); "
        "print(hashlib.sha256(bits).hexdigest())"
    )
    Simulation(flood(**EVERYTHING), "cpu")
    here = os.path.dirname(__file__)
    root = os.path.dirname(os.path.dirname(here))
    found = {
        subprocess.run([sys.executable, "-c", code, here, root], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True,
                       text=True, check=True).stdout
        for seed in "12"
    }
    assert len(found) == 1
