"""Spec 6: step sizes and numbers that no run can use are refused or warned of; never a silent NaN."""

import math
from typing import get_args

import numpy as np
import pytest
from extreme_scenes import BASE, NO_LIQUID, OPEN, all_finite, box, fill, merged, scene
from scene_runs import stepped

from melt import simulation
from melt.errors import GeometryError, InputError, MeltError, SceneError
from melt.geometry.build import build
from melt.preflight import plan
from melt.scene import Scene, scene_from_dict
from melt.scene.model import About
from melt.simulation import Simulation

LONG = {"dt": 1.0, "end": 5.0}


def test_a_long_step_lowers_the_sound_speed_and_says_so():
    long = scene(time={"dt": 0.2, "end": 1.0})
    assert any("sound speed was lowered" in f.text and "Lower time.dt" in f.text for f in plan(long).findings)
    sim = stepped(long, 3)
    assert sim.do.notes["n_sub"] == 16 and all_finite(sim)


def test_a_step_of_one_second_is_refused_before_the_run():
    with pytest.raises(MeltError, match=r"26 of them in dt = 1 s, but time.n_sub_max is 16 .*lower time.dt"):
        Simulation(scene(time=LONG), "cpu")


def test_a_fixed_number_of_sub_steps_that_is_too_few_is_a_warning_before_the_run():
    said = []

    def progress(event, message="", **_):
        said.append((event, message))

    try:
        sim = simulation.run(scene(time={**LONG, "n_sub": 1}), backend="cpu", progress=progress).simulation
    except MeltError:
        sim = None  # an unstable step may also end it: what counts is that it is not silent
    warnings = [text for event, text in said if event == "warning"]
    assert any(
        "time.n_sub = 1 makes sub-steps of 1 s" in text and "Fix: time.n_sub = " in text for text in warnings
    )
    if sim is not None:
        assert all_finite(sim)
        assert sim.series()["lost_particles"] > 0  # thrown out of the box, and counted


@pytest.mark.parametrize("solver", ["pairs_seq", "pairs_coloured", "cg"])
def test_heat_of_a_step_of_one_second_is_bounded_and_conserved(solver):
    sim = stepped(scene(time=LONG, heat={"solver": solver}, solver={"motion": False}), 0)
    before = sim.series()
    for _ in range(5):
        sim.step()
    after = sim.series()
    assert (
        before["temperature_min"]
        <= after["temperature_min"]
        < after["temperature_max"]
        <= before["temperature_max"]
    )
    assert after["temperature_max"] - after["temperature_min"] < 30
    scale = 50 * 40 * 0.008  # sum of V |T - T0|
    assert abs(after["thermal_energy"] - before["thermal_energy"]) <= 1e-5 * scale


@pytest.mark.parametrize("dt", [0, -0.1, math.nan, math.inf])
def test_a_step_by_hand_must_be_a_positive_number(dt):
    sim = Simulation(scene(), "cpu")
    with pytest.raises(
        InputError, match=r"dt = .* is not allowed: it must be a finite number greater than 0"
    ):
        sim.step(dt)
    assert issubclass(InputError, ValueError)
    assert sim.do.clock.step == 0


@pytest.mark.parametrize("until", [-1, math.nan, math.inf])
def test_an_end_that_is_no_time_is_refused_before_anything_is_written(until, tmp_path):
    with pytest.raises(InputError, match="until"):
        simulation.run(scene(), tmp_path / "a.vtkhdf", backend="cpu", until=until)
    assert list(tmp_path.iterdir()) == []


def _numbers(model, path=()):
    """Yield (path, may be infinite) of every number in the scene model, with list items as 0."""
    for name, field in model.model_fields.items():
        kinds, found = [field.annotation], set()
        while kinds:
            kind = kinds.pop()
            if hasattr(kind, "model_fields"):
                found.add(kind)
            elif kind in (float, int):
                found.add(kind)
            elif get_args(kind):
                kinds += [k for k in get_args(kind) if not isinstance(k, str | int)]
                found |= {list} & {getattr(kind, "__origin__", None)}
        here = (*path, name)
        for kind in found:
            if hasattr(kind, "model_fields") and kind is not About:
                yield from _numbers(kind, (*here, 0) if list in found else here)
        if {float, int} & found:
            yield (*here, 0) if list in found else here


FULL = merged(
    BASE,
    {
        "solid": [box([1, 1, 3], [2, 2, 2], name="a")],
        "obstacle": [box([0, 0, 5], [1, 1, 1])],
        "inflow": [
            {"position": [0.4, 0.4, 1.0], "direction": [0, 0, -1], "radius": 0.2, "speed": 1, "layers": 2}
        ],
        "heat": {"heater": [{"position": [0, 0, 0], "size": [1, 1, 1], "rate": 1.0}]},
        "domain": {"walls": {}},
    },
)


def _put(data, path, value):
    *inner, last = path
    for key in inner:
        if isinstance(data, dict):
            data = data.setdefault(key, [0.0, 0.0, 0.0] if last == 0 and key == inner[-1] else {})
        else:
            data = data[key]
    if isinstance(data, list) and last >= len(data):
        data.append(value)
    else:
        data[last] = value


def test_the_walk_over_the_model_finds_its_numbers():
    names = {".".join(map(str, path)) for path in _numbers(Scene)}
    assert len(names) > 90
    assert {"time.dt", "fluid.density", "solver.support", "solid.0.melting_point", "domain.gravity.0",
            "heat.heater.0.rate", "inflow.0.speed", "fluid.fill.0.lower.0"} <= names  # fmt: skip


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_no_number_of_a_scene_may_be_non_finite(value):
    """Every number of the model in turn; the message names it."""
    scene_from_dict(FULL)
    wrong = []
    for path in _numbers(Scene):
        data = merged(FULL, {})
        _put(data, path, value)
        key = ".".join(str(k) for k in path)
        if key == "solid.0.melting_point" and value == math.inf:
            scene_from_dict(data)  # it never melts
            continue
        try:
            scene_from_dict(data)
            wrong.append(f"{key} was taken")
        except SceneError as error:
            if key.removesuffix(".0") not in str(error):
                wrong.append(f"{key}: {error}")
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"fluid": {"alpha": 1e39}}, "fluid.alpha .* float32"),
        ({"domain": {"gravity": [0, 0, -1e39]}}, "fluid.gravity_z"),
        ({"fluid": {"density": 1e39}}, r"material_density\[0\] = 1e\+39 .* mixed precision"),
        ({"fluid": {"temperature": 1e39}}, r"temperature\[0\]"),
        ({"heat": {"conductivity": 1e300}}, r"material_conductivity\[0\]"),
        ({"domain": {"spacing": 1e12}}, r"mass\[0\]"),
        ({"time": {"dt": 1e-300}}, "time.dt = 1e-300 s is too small for float32"),
    ],
)
@pytest.mark.filterwarnings("ignore:overflow:RuntimeWarning")
def test_a_number_too_large_for_the_precision_is_refused_by_name(sections, words):
    with pytest.raises(InputError, match=words):
        Simulation(scene(**sections), "cpu")


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"domain": {"upper": [1e4, 1e4, 1e4]}}, "domain with walls: 1.25e\\+14 lattice cells"),
        ({"domain": {"upper": [1e300, 1, 1]}}, "domain with walls"),
        ({"domain": {"spacing": 1e-12}}, "domain with walls"),
        ({"fluid": fill([0, 0, 0], [50000, 50000, 50000])}, "fluid.fill 0"),
        ({"solid": [{"shape": "sphere", "radius": 1e3, "position": [0, 0, 0]}]}, "solid 'solid 0'"),
        (
            {"solid": [{"shape": "mesh", "file": "duck", "scale": 1e4, "position": [0, 0, 0]}]},
            "solid 'solid 0'",
        ),
        (
            {"solid": [{"shape": "mesh", "file": "duck", "particles": 2 * 10**9, "position": [0, 0, 0]}]},
            "2e\\+09",
        ),
        (
            {
                "inflow": [
                    {
                        "position": [0.4, 0.4, 1.0],
                        "direction": [0, 0, -1],
                        "radius": 0.2,
                        "speed": 1,
                        "layers": 10**9,
                    }
                ]
            },
            "inflow",
        ),
    ],
)
def test_a_scene_that_cannot_fit_is_refused_before_it_is_allocated(sections, words):
    with pytest.raises(GeometryError, match=words) as caught:
        build(scene(**sections))
    assert "domain.spacing" in str(caught.value)


def test_more_memory_than_the_machine_has_is_refused_before_it_is_allocated():
    with pytest.raises(MeltError, match=r"the run needs .* GB of memory, this machine has .*max_neighbours"):
        Simulation(scene(solver={"max_neighbours": 10**9}), "cpu")


def test_a_huge_open_domain_costs_no_more_than_its_particles():
    sim = stepped(scene(domain={"upper": [1e5, 1e5, 1e5], **OPEN}), 2)
    assert sim.state.sizes["cell"] <= 4096 + 2
    assert sim.state.sizes["particle"] == 40
    assert sim.series()["neighbours_max"] == 33  # as many as the same particles have in a small box
    small = stepped(scene(domain=OPEN), 2)
    assert np.abs(sim.read("position") - small.read("position")).max() < 1e-6


def test_a_speed_that_crosses_the_box_in_one_step_stops_the_run_at_once():
    fast = merged(BASE, {"solid": [{**BASE["solid"][0], "velocity": [0, 0, -1e4]}]})
    with pytest.raises(MeltError, match=r"bound 'speed' .*largest speed 1e\+04 m/s"):
        stepped(scene_from_dict(fast), 1)
    faster = merged(BASE, {"solid": [{**BASE["solid"][0], "velocity": [0, 0, 1e30]}], "time": {"n_sub": 2}})
    with pytest.raises(InputError, match=r"velocity\[2, \d+\] = 1e\+30 m/s .* of at most 1\.07e\+19 in mixed precision"):  # its square
        stepped(scene_from_dict(faster), 1)


def test_speeds_at_the_start_lay_out_the_first_step():
    thrown = scene(fluid=NO_LIQUID, solid=[box([1, 1, 3], [2, 2, 2], velocity=[0, 0, 50.0])], domain=OPEN)
    assert stepped(thrown, 1).do.notes["n_sub"] == math.ceil(0.005 / (0.4 * 0.25 / 50))
