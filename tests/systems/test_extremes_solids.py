"""Spec 6: bodies that melt at once, split, invert, touch; regions of one particle and of 1331 sites."""

import numpy as np
import pytest
from extreme_scenes import BASE, DX, NO_LIQUID, OPEN, WEIGHTLESS, all_finite, box, fill, scene
from scene_runs import stepped
from scipy.spatial.distance import pdist

from melt import simulation
from melt.geometry.build import build
from melt.output.run_reader import open_run
from melt.simulation import Simulation

SHEET = [box([0, 0, 3], [4, 4, 1], temperature=10.0)]
HOT = [box([1, 1, 3], [2, 2, 2], temperature=10.0)]
STUBBORN = {"melting_point": "never", "temperature": -10.0}


@pytest.mark.parametrize(
    "sections",
    [
        {},
        {"solver": {"baseline": "rigid"}},
        {"solver": {"solid_volume": "akinci"}},
        {"solver": {"refill": "all"}},
        {"solver": {"crumb": 8}},
        {"heat": {"refreeze": True}},
        {"solver": {"melt_to": "own", "density_form": "volume"}},
    ],
    ids=lambda s: str(s),
)
def test_a_sheet_melts_whole_in_one_step(sections, tmp_path):
    path = tmp_path / "run.vtkhdf"
    thin = scene(solid=SHEET, **sections)
    sim = stepped(thin, 1)
    assert sim.series()["solid_particles"] == 0 and sim.do.clock.melted == 16
    for name, vacant in (("site_component", -1), ("site_link_count", 0), ("site_region_count", 0)):
        assert (sim.state.read(name)[:16] == vacant).all()
    assert (sim.state.read("site_particle") == -1).all()
    assert (sim.state.read("site_links") == -1).all() and (sim.state.read("site_region") == -1).all()
    sim = simulation.run(thin, path, backend="cpu").simulation
    assert all_finite(sim)
    with open_run(path) as run:
        assert run.series["solid_particles"].tolist() == [16, 0, 0, 0, 0, 0]
        assert run.series["mass"][-1] == pytest.approx(
            48 * 8.0 - (16 * 8 * (1 - 0.917) if "own" in str(sections) else 0)
        )


def test_a_body_melts_layer_by_layer_to_its_last_region():
    """5^3, hot inside: 125, 27, 1, 0; the last region disappears with the step."""
    hot = box([0, 0, 1], [5, 5, 5], temperature=10.0)
    sim = Simulation(
        scene(fluid=NO_LIQUID, solid=[hot], domain={**WEIGHTLESS, "upper": [1.0, 1.0, 1.4]}), "cpu"
    )
    counts = []
    for _ in range(5):
        sim.step()
        counts.append(sim.series()["solid_particles"])
        assert all_finite(sim)
    assert counts == [27, 1, 0, 0, 0]
    assert sim.series()["melted_fraction"] == 1


@pytest.mark.parametrize("width", [0, 5])
def test_smallest_and_largest_regions_run_to_the_end_of_the_body(width):
    sim = Simulation(scene(solver={"width": width}, solid=HOT), "cpu")
    assert sim.state.sizes["region"] == (2 * width + 1) ** 3
    assert (sim.state.read("site_region_count") == (1 if width == 0 else 8)).all()
    for _ in range(3):
        sim.step()
    assert sim.series()["solid_particles"] == 0 and all_finite(sim)


def test_regions_of_one_particle_make_free_particles():
    """w = 0: no goals, so each falls as if alone; w = 2 holds the body together."""
    spread = {}
    for width in (0, 2):
        apart = scene(
            fluid=NO_LIQUID,
            solid=[box([1, 1, 3], [2, 2, 2], **STUBBORN)],
            domain=WEIGHTLESS,
            solver={"width": width},
        )
        initial = build(apart)
        initial.arrays["velocity"][:] = 0.5 * (
            initial["position"] - initial["position"].mean(axis=1, keepdims=True)
        )
        sim = Simulation(apart, "cpu", initial=initial)
        for _ in range(40):
            sim.step()
        spread[width] = np.ptp(sim.read("position"), axis=0) / DX
    assert spread[0] == pytest.approx([1.1] * 3, rel=1e-3)  # 1 + 0.5/s times 0.2 s
    assert spread[2] == pytest.approx([1.0] * 3, abs=1e-2)


def test_bodies_in_adjacent_voxels_do_not_bond():
    pair = [box([0, 1, 1], [2, 2, 2], name="a", velocity=[-1, 0, 0], **STUBBORN),
            box([2, 1, 1], [2, 2, 2], name="b", velocity=[1, 0, 0], **STUBBORN)]  # fmt: skip
    sim = Simulation(scene(fluid=NO_LIQUID, domain=WEIGHTLESS, solid=pair), "cpu")
    assert (sim.state.read("site_link_count") == 8).all()
    assert np.unique(sim.state.read("site_component")).tolist() == [0, 8]
    for _ in range(20):
        sim.step()
    assert sim.read("velocity")[:, 0] == pytest.approx(np.repeat([-1.0, 1.0], 8), abs=1e-4)
    x = sim.read("position")[:, 0].reshape(2, 8)
    assert x[1].min() - x[0].max() == pytest.approx(DX + 2 * 0.1, rel=1e-3)


def test_bodies_that_meet_do_not_pass_through_each_other():
    pair = [box([0, 1, 1], [2, 2, 2], name="a", velocity=[1, 0, 0], **STUBBORN),
            box([4, 1, 1], [2, 2, 2], name="b", velocity=[-1, 0, 0], **STUBBORN)]  # fmt: skip
    sim = Simulation(
        scene(fluid=NO_LIQUID, domain={**WEIGHTLESS, "upper": [1.4, 0.8, 0.8]}, solid=pair), "cpu"
    )
    for _ in range(120):
        sim.step()
        x = sim.read("position")[:, 0].reshape(2, 8)
        assert x[1].min() - x[0].max() > 0.5 * DX
    assert sim.read("velocity")[:8, 0].mean() < 0 < sim.read("velocity")[8:, 0].mean()
    momentum = sim.series()["momentum_x"]
    assert abs(momentum) < 1e-4 * 16 * 0.008 * 917


def squashed(factors, **solver):
    """Return (simulation of a 3^3 body pressed by ``factors`` about its middle, distances at rest)."""
    body = scene(
        fluid=NO_LIQUID,
        domain={**WEIGHTLESS, "upper": [1.0, 1.0, 1.0]},
        heat=None,
        solver=solver,
        solid=[box([1, 1, 1], [3, 3, 3])],
    )
    initial = build(body)
    x = initial["position"]
    rest, middle = pdist(x.T), x.mean(axis=1, keepdims=True)
    initial.arrays["position"] = middle + (x - middle) * np.array(factors)[:, None]
    return Simulation(body, "cpu", initial=initial), rest


BROKEN = {"mirrored": (-1, 1, 1), "a plane": (1, 1, 0), "a line": (1, 0, 0), "a point": (0, 0, 0)}


@pytest.mark.parametrize("rotation", ["horn", "svd", "iterative"])
@pytest.mark.parametrize("how", BROKEN)
def test_broken_bodies_recover_within_50_steps(how, rotation):
    """The jump back leaves each particle with (g - x)/dt: with damping 0.3 that is gone after 50 steps."""
    sim, rest = squashed(BROKEN[how], rotation=rotation, damping=0.3)
    for _ in range(50):
        sim.step()
        q = sim.state.read("region_rotation")
        assert (q**2).sum(axis=0) == pytest.approx(np.ones(27), abs=1e-4)  # a proper rotation at every step
    assert np.abs(pdist(sim.read("position")) - rest).max() < 0.01 * DX


@pytest.mark.parametrize("how", BROKEN)
def test_broken_bodies_ring_down_with_the_default_damping(how):
    sim, rest = squashed(BROKEN[how])
    errors = []
    for _ in range(4):
        for _ in range(50):
            sim.step()
        errors.append(np.abs(pdist(sim.read("position")) - rest).max() / DX)
    assert errors[0] < 0.5 and errors[-1] < 0.02


@pytest.fixture(scope="module")
def light():
    """Heights of the middle of a cube of 1 % of the liquid's density, for 3 s, and the simulation."""
    sim = Simulation(
        scene(
            domain={"upper": [1.2, 1.2, 1.2]},
            heat=None,
            fluid=fill([0, 0, 0], [6, 6, 3]),
            solver={"precision": "double"},
            solid=[box([2, 2, 3], [2, 2, 2], density=10.0)],
        ),
        "cpu",
    )
    solid, height = sim.initial["phase"] == 1, []
    for _ in range(600):
        sim.step()
        height.append(sim.read("position")[solid, 2].mean())
    return np.array(height), sim


def test_a_hundredth_of_the_density_floats_with_its_own_time_step(light):
    height, sim = light
    assert sim.do.notes["governing_bound"] == "light solid"
    # 0.4 h_s / (c_s (1 + 0.6 alpha)) sqrt(0.01 / 0.05)
    bound = 0.4 * 0.25 / (sim.prepared.settings.sound_speed * 1.12) * np.sqrt(0.2)
    assert sim.do.notes["n_sub"] == int(np.ceil(0.005 / bound))
    assert all_finite(sim)
    assert 0.6 < height[-240:].mean() < 1.2  # on the liquid, whose surface is at 0.6 m
    assert height.max() < 1.8  # not thrown out


def test_a_hundredth_of_the_density_floats_without_jitter(light):
    """Against its running mean over 0.2 s, in the last 1.2 s: at most 0.05 spacings."""
    late = light[0][-240:]
    smooth = np.convolve(late, np.ones(40) / 40, mode="same")
    assert (late - smooth)[20:-20].std() < 0.05 * DX


def test_a_hundred_times_the_density_sinks_and_stays_above_the_floor():
    heavy = scene(
        domain={"upper": [1.2, 1.2, 1.2]},
        heat=None,
        fluid=fill([0, 0, 0], [6, 6, 3]),
        solid=[box([2, 2, 2], [2, 2, 2], density=1e5)],
    )
    sim = Simulation(heavy, "cpu")
    solid = sim.initial["phase"] == 1
    lowest, hits = [], []
    for _ in range(200):
        sim.step()
        lowest.append(sim.read("position")[solid, 2].min())
        hits.append(sim.series()["guard_pairs"])
    # floor particles are at -0.1 m; in the hollow between four of them the body stands at +0.04 m
    assert min(lowest) > 0.0
    assert lowest[-1] < 0.15
    assert sim.series()["guard_pairs"] == hits[-1]  # reported, whether or not the guard was needed


def test_liquid_below_a_body_is_removed_at_the_start_and_counted():
    inside = scene(solid=[box([1, 1, 1], [2, 2, 2])])
    initial = build(inside)
    assert any("removed 4 liquid particles closer than 0.9 dx" in note for note in initial.notes)
    said = []
    simulation.run(
        inside,
        backend="cpu",
        until=0.0,
        progress=lambda event, message="", **_: said.append((event, message)),
    )
    assert any(event == "warning" and "removed 4 liquid particles" in text for event, text in said)


def test_a_body_without_walls_or_liquid_falls_as_one():
    sim = stepped(scene(fluid=NO_LIQUID, solid=[{**BASE["solid"][0], **STUBBORN}], domain=OPEN), 40)
    assert np.ptp(sim.read("velocity"), axis=0).max() < 1e-4
