"""Spec 6: conductivities from 0 to 1e30, equal temperatures, melting points at the last bit."""

import numpy as np
import pytest
from extreme_scenes import BASE, NO_LIQUID, WEIGHTLESS, box, fill, scene
from scene_runs import stepped

from melt.errors import MeltError
from melt.geometry.build import build
from melt.preflight import plan
from melt.simulation import Simulation

SOLVERS = ["auto", "pairs_seq", "pairs_coloured", "onesided", "cg", "explicit"]
CONSERVING = ["auto", "pairs_seq", "pairs_coloured", "cg"]


def heated(K, solver, steps, **sections):
    """Return (T at the start, simulation) with conductivity K everywhere."""
    heat = {"solver": solver, "conductivity": K, **sections.pop("heat", {})}
    sim = stepped(scene(solid=[{**BASE["solid"][0], "conductivity": K}], heat=heat, **sections), 0)
    start = sim.read("temperature")
    for _ in range(steps):
        sim.step()
    return start, sim


@pytest.mark.parametrize("solver", SOLVERS)
def test_no_conductivity_leaves_every_bit_of_the_temperatures(solver):
    start, sim = heated(0.0, solver, 3)
    assert np.unique(start).size == 2
    assert np.array_equal(start.view(np.uint32), sim.read("temperature").view(np.uint32))


@pytest.mark.parametrize("solver", SOLVERS)
def test_equal_temperatures_stay_equal_to_the_bit(solver):
    T = np.float32(-1.2345678)
    sections = {"solid": [{**BASE["solid"][0], "temperature": float(T)}], "fluid": {"temperature": float(T)}}
    sim = stepped(scene(heat={"solver": solver, "conductivity": 80.0}, **sections), 3)
    assert (sim.read("temperature") == T).all()


@pytest.mark.parametrize("K", [1e6, 1e30])
@pytest.mark.parametrize("solver", [s for s in SOLVERS if s != "explicit"])
def test_huge_conductivities_keep_the_bounds(solver, K):
    start, sim = heated(K, solver, 5)
    mobile = sim.read("phase") != 2
    T = sim.read("temperature")[mobile]
    assert np.isfinite(T).all()
    assert start.min() <= T.min() and T.max() <= start.max()
    if solver in CONSERVING:
        assert np.ptp(T) < 15  # of 50 K
        assert abs(T.astype(float).sum() - start[mobile].astype(float).sum()) <= 1e-5 * 50 * T.size


@pytest.mark.parametrize("K", [1e6, 1e30])
@pytest.mark.parametrize("solver", CONSERVING)
def test_a_pair_alone_is_equalised_at_once(solver, K):
    """Two particles of equal volume end at the mean."""
    sections = {
        "fluid": {**fill([1, 1, 1], [1, 1, 1]), "temperature": 40.0},
        "solid": [box([1, 1, 2], [1, 1, 1], temperature=-10.0, conductivity=K, melting_point=1e9)],
        "domain": WEIGHTLESS,
    }
    sim = stepped(scene(heat={"solver": solver, "conductivity": K}, **sections), 1)
    # backward Euler of the whole step leaves D / (1 + dt G (1/C_i + 1/C_j)) = 0.113 K at 1e6
    assert sim.read("temperature") == pytest.approx([15.0, 15.0], abs=0.06 if K == 1e6 else 1e-3)


def test_conjugate_gradients_report_their_work_and_fall_back_when_they_do_not_converge():
    _, sim = heated(1e4, "cg", 1)
    values = sim.series()
    assert values["heat_iterations"] > 1
    assert 0 <= values["heat_residual"] <= 1e-3
    assert "heat_fallback" not in values
    _, sim = heated(1e6, "cg", 2, heat={"max_iterations": 1, "tolerance": 1e-7})
    assert sim.series()["heat_fallback"] == 1


def test_sub_steps_without_end_are_refused():
    with pytest.raises(MeltError, match="explicit.*lower time.dt or the conductivity.*heat.solver to 'auto'"):
        heated(1e30, "explicit", 1)
    with pytest.raises(MeltError, match="heat.substeps = 'auto'.*lower time.dt"):
        plan(scene(heat={"conductivity": 1e30, "substeps": "auto"}))


def test_explicit_heat_takes_the_sub_steps_that_it_needs():
    start, sim = heated(1e5, "explicit", 2)
    T = sim.read("temperature")[sim.read("phase") != 2]
    assert sim.series()["heat_iterations"] > 100
    assert start.min() <= T.min() and T.max() <= start.max()


@pytest.mark.parametrize("precision", ["mixed", "double"])
def test_melting_begins_at_the_melting_point_and_not_one_bit_below(precision):
    real = np.float64 if precision == "double" else np.float32
    for T, left in ((real(0), 0), (np.nextafter(real(0), real(-1)), 8)):
        cold = scene(heat={"conductivity": 0.0}, solver={"precision": precision})
        initial = build(cold)
        initial.arrays["temperature"][:] = T
        sim = Simulation(cold, "cpu", initial=initial)
        sim.step()
        assert sim.series()["solid_particles"] == left


def test_an_infinite_melting_point_outlasts_any_heat():
    never = box([1, 1, 3], [2, 2, 2], temperature=1e6, melting_point="never")
    sim = stepped(scene(solid=[never]), 5)
    values = sim.series()
    assert values["solid_particles"] == 8 and values["temperature_max"] > 9e5
    assert "melt_test" not in sim.do.launches  # nothing can melt, so nothing is tested
    sim = stepped(scene(solid=[never, box([0, 0, 3], [1, 1, 1], melting_point=0, temperature=10.0)]), 2)
    assert sim.series()["solid_particles"] == 8  # the other one, tested beside it, went


def test_one_of_each_exchange_heat_and_nothing_else():
    sections = {"fluid": fill([1, 1, 0], [1, 1, 1]), "solid": [box([1, 1, 1], [1, 1, 1], temperature=-10.0)]}
    sim = stepped(scene(**sections), 10)
    T = sim.read("temperature")[sim.read("phase") != 2]
    assert -9 < T.min() and T.max() < 39 and T.sum() == pytest.approx(30.0, abs=1e-4)


def test_a_single_particle_keeps_its_temperature():
    for sections in (
        {"fluid": fill([1, 1, 1], [1, 1, 1]), "solid": []},
        {"fluid": NO_LIQUID, "solid": [box([1, 1, 1], [1, 1, 1], temperature=-10.0)]},
    ):
        start, sim = heated_alone(sections)
        assert np.array_equal(start, sim.read("temperature"))


def heated_alone(sections):
    sim = Simulation(scene(domain=WEIGHTLESS, **sections), "cpu")
    start = sim.read("temperature")
    for _ in range(3):
        sim.step()
    return start, sim
