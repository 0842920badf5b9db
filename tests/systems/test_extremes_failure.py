"""Spec 6: values that are not finite, at the start and within a run. Frames before them are kept."""

import re

import numpy as np
import pytest
from extreme_scenes import scene

from melt import simulation
from melt.errors import InputError, MeltError
from melt.geometry.build import build
from melt.output import checkpoint
from melt.output.run_reader import open_run
from melt.simulation import Simulation
from melt.stages import STAGES


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    ("name", "first", "more", "said"),
    [
        ("position", (1, 30), (2, 3), r"position\[1, 30\] = -?(nan|inf) m \(and 1 more\)"),
        ("velocity", (2, 5), (2, 9), r"velocity\[2, 5\] = -?(nan|inf) m/s \(and 1 more\)"),
        ("temperature", 7, 35, r"temperature\[7\] = -?(nan|inf) degC \(and 1 more\)"),
        ("mass", 8, 9, r"mass\[8\] = -?(nan|inf) kg \(and 1 more\)"),
    ],
)
def test_bad_initial_values_are_refused_with_the_first_index(name, first, more, said, value):
    initial = build(scene())
    initial.arrays[name][first] = initial.arrays[name][more] = value
    with pytest.raises(InputError, match=said) as caught:
        Simulation(scene(), "cpu", initial=initial)
    assert isinstance(caught.value, ValueError) and "\n" not in str(caught.value)


def test_bad_material_values_are_refused():
    for value, taken in ((np.nan, False), (np.inf, True)):
        initial = build(scene())
        initial.arrays["material_melting_point"][1] = value
        if taken:
            Simulation(scene(), "cpu", initial=initial)  # never melts
        else:
            with pytest.raises(InputError, match=r"material_melting_point\[1\] = nan"):
                Simulation(scene(), "cpu", initial=initial)


@pytest.mark.parametrize("name", ["mass", "rest_volume"])
@pytest.mark.parametrize("value", [0.0, -1.0])
def test_particles_without_mass_or_volume_are_refused(name, value):
    initial = build(scene())
    initial.arrays[name][33] = value
    with pytest.raises(InputError, match=rf"{name}\[33\] = {value:g} .* more than 0"):
        Simulation(scene(), "cpu", initial=initial)


def plant(sim, name, particle, value=np.nan):
    """Write ``value`` into the last component of a field of the particle with this id."""
    values = sim.state.read(name)
    values[..., int(np.flatnonzero(sim.state.read("id") == particle)[0])] = value
    sim.state.set(name, values)


def named(text):
    """Return (field, stages that write it, particle) that an error names."""
    found = re.search(r"field (\w+) (?:or of force/mass )?\(stage ([\w ]+)\).*particle (\d+)", text)
    return found[1], set(found[2].split(" or ")), int(found[3])


LIQUID, SOLID = 5, 35


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("particle", [LIQUID, SOLID])
@pytest.mark.parametrize("name", ["position", "velocity", "temperature"])
def test_a_value_that_turns_bad_stops_the_run_and_is_named(name, particle, value):
    sim = Simulation(scene(), "cpu")
    for _ in range(3):
        sim.step()
    plant(sim, name, particle, value)
    with pytest.raises(MeltError, match=r"step 4, t = 0.02 s: .* frames before are kept") as caught:
        sim.step()
    field, stages, culprit = named(str(caught.value))
    assert "\n" not in str(caught.value)
    where = int(np.flatnonzero(sim.state.read("id") == culprit)[0])
    assert not np.isfinite(sim.state.read(field)[..., where]).all()
    assert stages and all(field in STAGES[stage].writes for stage in stages)
    if name == "temperature":
        assert (field, stages) == ("temperature", {"heat_pairs_coloured"})
    elif (name, particle) == ("position", LIQUID):  # nobody is near it, so it alone is bad
        assert (field, culprit) == ("position", LIQUID) and "drift" in stages


def test_a_particle_that_turns_bad_is_not_deleted_as_one_that_left():
    sim = Simulation(scene(domain={"leave": "delete"}), "cpu")
    sim.step()
    plant(sim, "position", LIQUID)
    with pytest.raises(MeltError, match="field position .*particle 5"):
        sim.step()


@pytest.mark.parametrize("solver", ["pairs_coloured", "pairs_seq", "onesided", "cg"])
def test_bad_temperatures_are_found_without_motion(solver):
    sim = Simulation(scene(solver={"motion": False}, heat={"solver": solver}), "cpu")
    sim.step()
    plant(sim, "temperature", SOLID)
    with pytest.raises(MeltError, match="field temperature"):
        sim.step()


def test_frames_and_checkpoint_before_a_bad_value_are_kept_and_the_run_can_go_on(tmp_path):
    import vtk

    path, whole = tmp_path / "run.vtkhdf", tmp_path / "whole.vtkhdf"
    long = scene(time={"end": 0.1})
    simulation.run(long, whole, backend="cpu")
    running = {}

    def progress(event, simulation=None, step=0, **_):
        running.setdefault("sim", simulation) if event == "start" else None
        if event == "step" and step == 9:
            plant(running["sim"], "velocity", LIQUID)

    with pytest.raises(MeltError, match="step 10, t = 0.05 s"):
        simulation.run(long, path, backend="cpu", progress=progress)
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 5  # t = 0 .. 0.04: the bad frame is not among them
    with open_run(path) as run:
        assert all(
            np.isfinite(run.frame(k)[f]).all()
            for k in range(5)
            for f in ("position", "velocity", "temperature")
        )
    arrays, meta = checkpoint.load(checkpoint.beside(path))
    assert meta["clock"]["step"] == 8 and np.isfinite(arrays["velocity"]).all()
    simulation.resume(path)
    with open_run(path) as again, open_run(whole) as right:
        assert len(again) == len(right) == 11
        assert all(np.array_equal(again.frame(10)[f], right.frame(10)[f]) for f in right.fields)


def test_a_checkpoint_of_another_scene_is_refused(tmp_path):
    path, other = tmp_path / "run.vtkhdf", tmp_path / "other.vtkhdf"
    simulation.run(scene(), path, backend="cpu")
    simulation.run(scene(fluid={"temperature": 41.0}), other, backend="cpu")
    checkpoint.beside(other).replace(checkpoint.beside(path))
    before = path.read_bytes()
    with pytest.raises(MeltError, match="another scene.*start the run afresh"):
        simulation.resume(path)
    assert path.read_bytes() == before


def test_replacing_a_run_removes_the_checkpoint_of_the_old_one(tmp_path):
    path = tmp_path / "run.vtkhdf"
    simulation.run(scene(), path, backend="cpu")
    assert checkpoint.beside(path).exists()
    simulation.run(
        scene(time={"checkpoint_every": "never", "end": 0.03}), path, backend="cpu", overwrite=True, until=0.0
    )
    assert not checkpoint.beside(path).exists()
    with pytest.raises(MeltError, match="checkpoint"):
        simulation.resume(path)
