"""The same problem told otherwise has the same answer: moved, turned, in another order, in other units.

What is asked of the answers is stated beside each test. "To rounding" is `AMPLIFIED` units in the last place of the
largest coordinate, over three outer steps: a step turns an error of a distance into one of a pressure, and back.
"""

import copy

import numpy as np
import pytest
from free_scenes import SCENES
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_changes import moved, permuted, quarter, rescaled, turned
from scene_runs import stepped

from melt.geometry.build import build
from melt.physics.phases import LIQUID, SOLID, WALL
from melt.scene import scene_from_dict

STEPS, AMPLIFIED = 3, 300
EPS = {"double": 2.0**-52, "single": 2.0**-23}
#: Random draws of columns turn a rounding into another draw; a lattice stays.
LATTICE = {"layout": "lattice", "even": False, "jitter": 0.0}
MOST = settings().max_examples


def few(count):
    """Settings of a test whose examples each take two runs."""
    return settings(max_examples=count if MOST <= 100 else MOST // 10)


def case(system, precision="double"):
    data = copy.deepcopy(SCENES[system])
    data["solver"]["precision"] = precision
    if system == "flood":
        data["fluid"] |= LATTICE
    return data


def end(data, **options):
    return stepped(scene_from_dict(data), STEPS, "reference", **options)


def dimensions(system):
    return 2 if system == "flood" else 3


def of_world(sim, x):
    """Return places (n, 3) as the scene tells them: floods reckon in the terrain's own frame."""
    return sim.initial.terrain.world(x[:, :2].T.astype(float)).T if sim.scene.kind == "flood" else x


def length_of(data):
    box = data.get("domain", data["terrain"] if "terrain" in data else None)
    return max(b - a for a, b in zip(box["lower"], box["upper"]))


def close(data, one, other, reach=0.0):
    """Hold that places and velocities of two ends, already in the same units, are equal to rounding."""
    (x, v, T), (y, w, U) = one, other
    allowed = AMPLIFIED * EPS[data["solver"]["precision"]] * (reach + length_of(data))
    assert np.abs(x - y).max() <= allowed
    assert np.abs(v - w).max() <= allowed / data["time"]["dt"]
    if T is not None:
        assert np.abs(T - U).max() <= AMPLIFIED * EPS[data["solver"]["precision"]] * 100 * (1 + reach / length_of(data))


def told(sim):
    """Return (positions, velocities, temperatures or None) by id."""
    return of_world(sim, sim.read("position")), sim.read("velocity"), sim.read("temperature") if "temperature" in sim.state else None


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("system", SCENES)
def test_a_moved_scene_moves_alike_to_rounding(system, precision):
    """Single precision keeps positions to a part in 2^23 of the largest coordinate: it is moved by its own size at most."""
    data = case(system, precision)
    still = told(end(data))
    most = 1000.0 if precision == "double" else 2 * length_of(data)

    @few(3)
    @given(st.tuples(*[st.floats(-most, most, allow_subnormal=False)] * dimensions(system)))
    def moves(shift):
        shift = np.array(shift)
        if data.get("domain", {}).get("dimensions") == 2:
            shift[1] = 0.0
        sim = end(moved(data, shift))
        x, v, T = told(sim)
        close(data, still, (x - shift, v, T), reach=np.abs(shift).max())

    moves()


@pytest.mark.parametrize("system", ["melting", "position based", "flood"])
def test_a_turned_scene_turns_alike_to_rounding(system):
    """By 90 degrees about the vertical. Particles are numbered along the grid: they are matched by where they began.

    What is drawn at random (nucleation, ghosts) goes by these numbers and the grid, and turns no more than the dice do.
    """
    data = case(system)
    ends, starts = [], []
    for scene in (data, turned(data)):
        sim = end(scene)
        start = end_of_start(sim)
        ends.append(told(sim)), starts.append(start)
    turned_start = np.round(quarter(starts[0]), 9)
    order, match = (np.lexsort(np.round(x, 9).T) for x in (turned_start, starts[1]))
    assert np.allclose(turned_start[order], starts[1][match], atol=1e-9)
    (x, v, T), (y, w, U) = ends
    found = (quarter(x)[order], quarter(v)[order], None if T is None else T[order])
    close(data, found, (y[match], w[match], None if U is None else U[match]))


def end_of_start(sim):
    """Return where the particles began, by id."""
    return of_world(sim, sim.initial["position"].T[np.argsort(sim.initial["id"], kind="stable")])


@few(4)
@given(st.sampled_from(["wcsph", "dfsph", "isph"]), st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_a_free_blob_turns_with_gravity_to_rounding(pressure, q):
    """Any rotation about the middle of a box without walls, gravity turned along."""
    q = np.array(q) / np.linalg.norm(q)
    (w, x, y, z) = q
    R = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                  [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                  [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    data = copy.deepcopy(SCENES["position based"])
    data["solver"] = {"pressure": pressure, "precision": "double"}
    data["domain"] |= {"lower": [-1.0, -1.0, -1.0], "upper": [1.0, 1.0, 1.0], "walls": {"sides": "none"}}
    data["fluid"]["fill"] = [{"lower": [-0.2, -0.1, -0.2], "upper": [0.2, 0.2, 0.1], "velocity": [0.3, 0.1, 0.2]}]
    one = told(end(data))
    initial = build(scene_from_dict(data))
    for name in ("position", "velocity"):
        initial.arrays[name] = np.ascontiguousarray(R @ initial[name])
    data["domain"]["gravity"] = (R @ data["domain"]["gravity"]).tolist()
    other = told(end(data, initial=initial))
    close(data, (one[0] @ R.T, one[1] @ R.T, None), (*other[:2], None))


@pytest.mark.parametrize("system", SCENES)
def test_the_order_of_particles_is_of_no_account_to_rounding(system):
    """Ids stay with their particles; sums over neighbours run in the order of the cells, within a cell in that of the start."""
    data = case(system)
    whole = told(end(data))
    initial = build(scene_from_dict(data))

    @few(2)
    @given(st.integers(0, 2**32))
    def is_of_no_account(seed):
        phases = (LIQUID, WALL) if SOLID in initial["phase"] else (LIQUID,)
        found = told(end(data, initial=permuted(initial, seed, phases)))
        close(data, whole, found)

    is_of_no_account()


@pytest.mark.parametrize("system", SCENES)
def test_other_units_give_the_same_answer(system):
    """Powers of four are exact in binary numbers, and so are their roots: bit by bit. Any other factor: to rounding."""
    data, exact = SCENES[system], st.sampled_from([1 / 16, 1 / 4, 1.0, 4.0, 16.0])
    whole = told(end(data))

    @few(3)
    @given(exact, exact, exact)
    def bit_by_bit(mass, length, time):
        x, v, T = told(end(rescaled(data, mass, length, time)))
        assert np.array_equal(x / length, whole[0]) and np.array_equal(v * time / length, whole[1])
        assert T is None or np.array_equal(T, whole[2])

    bit_by_bit()
    lattice = case(system)
    evenly = told(end(lattice))

    @few(2)
    @given(*[st.sampled_from([2**0.5, 2.0, 0.3048, 1e3, 1.0])] * 3)
    def to_rounding(mass, length, time):
        x, v, T = told(end(rescaled(lattice, mass, length, time)))
        close(lattice, evenly, (x / length, v * time / length, T))

    to_rounding()


@given(st.decimals(-1000, 1000, allow_nan=False, places=4))
def test_a_length_in_centimetres_is_the_same_number_in_metres(value):
    scenes = []
    for text in (f"{value} m", f"{value * 100} cm", f"{value * 1000} mm", f"{value / 1000} km", float(value)):
        data = copy.deepcopy(SCENES["melting"])
        data["domain"]["lower"] = [text, 0.0, 0.0]
        data["domain"]["upper"][0] = 2000.0
        scenes.append(scene_from_dict(data))
    assert all(scene == scenes[0] for scene in scenes)
