"""Vapour: birth, density, forces, motion, effect precision (boiling 2.6, eq (16))."""

import numpy as np
import pytest
from bubble_cases import BUBBLE, FAR, INACTIVE, LIQUID, VAPOUR, VAPOUR_VALUES, WALL, R, poly6, pool, rounding, run
from liquid_cases import both, everywhere
from pbf_cases import D

M, K, RHO0 = (VAPOUR_VALUES[name] for name in ("mass", "stiffness", "rest_density"))


def source(backend, precision="double", per_burst=3, served=5, first_id=70, step=9, **changes):
    x = [[0.1, 0.2, 0.3], [0.5, 0.6, 0.7], [9, 9, 9], [0, 0, 0], [9, 9, 9], [9, 9, 9], [9, 9, 9], [9, 9, 9]]
    phase = [BUBBLE, BUBBLE, INACTIVE, LIQUID] + [INACTIVE] * 4
    a = pool(
        x, phase, precision, burst_index=[1, 0] + [-1] * 6, burst_top=[0.31, 0.75] + [0] * 6, free_index=[2, 4, 5, 6, 7, -1, -1, -1],
        velocity=np.full((3, 8), 3.0), id=np.arange(8), vapour_support=np.zeros(8), rest_volume=np.full(8, 1.0), age=np.full(8, 1.0),
    )
    before = {name: value.copy() for name, value in a.items()}
    run("vapour_source", backend, a, step_low=step, step_high=0, first_id=first_id, served=served, per_burst=per_burst, **changes)
    return a, before


@everywhere
@both
def test_source_fills_the_first_slots_around_the_bursts(backend, precision):
    a, before = source(backend, precision)
    new = [2, 4, 5, 6, 7]
    assert a["phase"].tolist() == [BUBBLE, BUBBLE, VAPOUR, LIQUID] + [VAPOUR] * 4
    assert a["id"][new].tolist() == [70, 71, 72, 73, 74]
    real = a["mass"].dtype.type
    for name, value in (("mass", M), ("rest_volume", 0), ("temperature", 100), ("age", 0), ("vapour_support", R)):
        assert (a[name][new] == real(value)).all(), name
    assert (a["velocity"][:, new] == 0).all()
    centre = np.array([[0.5, 0.6, 0.75]] * 3 + [[0.1, 0.2, 0.31]] * 2).T
    away = a["position"][:, new] - centre
    assert (np.sqrt((away**2).sum(axis=0)) <= D * (1 + 1e-5)).all() and (away[2] >= -1e-7).all()
    assert np.abs(away).max() > 0.5 * D and len({*away[0].tolist()}) == 5  # all different
    for name in ("phase", "id", "position", "velocity", "mass", "rest_volume", "temperature", "age", "vapour_support"):
        assert (np.delete(a[name], new, axis=-1) == np.delete(before[name], new, axis=-1)).all(), name


@everywhere
def test_source_places_are_those_of_the_generator(backend):
    """Stream 3 by id, mirrored up: the same on all backends, another in another step or with another seed."""
    from melt.reference._philox import ball_offset

    a, _ = source(backend, per_burst=1, served=2, first_id=123456)
    for slot, id, centre in ((2, 123456, [0.5, 0.6, 0.75]), (4, 123457, [0.1, 0.2, 0.31])):
        x, y, z = ball_offset(id, 9, 0, 1, 0, 3)
        assert a["position"][:, slot] == pytest.approx(np.array(centre) + D * np.array([x, y, abs(z)]), rel=1e-14)
    for other in (source(backend, step=10)[0], source(backend, seed_low=2)[0], source(backend, first_id=71)[0]):
        assert (other["position"][0, 2:3] != source(backend)[0]["position"][0, 2:3]).all()
    nothing, before = source(backend, served=0)
    assert all((nothing[name] == before[name]).all() for name in ("phase", "position", "id"))


@everywhere
@both
def test_density_by_hand(backend, precision):
    """Itself and its vapour neighbours, R_ij the mean of both; liquid, bubbles and inactive slots do not count."""
    x = [[0, 0, 0], [D, 0, 0], [0, 0.5 * D, 0], [0, 0, D], [0, 0, -D], [D, 0, 0]]
    a = pool(
        x, [VAPOUR, VAPOUR, VAPOUR, LIQUID, BUBBLE, INACTIVE], precision, vapour_support=np.array([1, 0.8, 0.5, 0, 0, 1]) * R,
        vapour_density=np.full(6, 7.0), vapour_pressure=np.full(6, 7.0),
    )
    out = run("vapour_density", backend, a)
    far = np.sqrt(1.25) * D
    rho = M * np.array([
        poly6(0, R) + poly6(D, 0.9 * R) + poly6(0.5 * D, 0.75 * R),
        poly6(0, 0.8 * R) + poly6(D, 0.9 * R) + poly6(far, 0.65 * R),
        poly6(0, 0.5 * R) + poly6(0.5 * D, 0.75 * R) + poly6(far, 0.65 * R),
    ])
    rel = 10 * rounding(precision)[0]
    assert out["vapour_density"] == pytest.approx(np.append(rho, [7] * 3), rel=rel)
    assert out["vapour_pressure"] == pytest.approx(np.append(K * (rho - RHO0), [7] * 3), rel=rel)
    assert (run("vapour_density", backend, a, rest_density=50.0)["vapour_pressure"][:3] == 0).all()


@everywhere
@both
def test_pressure_of_a_pair_by_hand(backend, precision):
    """Equal and opposite momentum although the two have unequal density, pressure and support."""
    a = pool(
        [[0, 0, 0], [0, D, 0]], VAPOUR, precision, vapour_density=[0.5, 0.8], vapour_pressure=[3.0, 1.0],
        vapour_support=[R, 0.8 * R], temperature=[20.0, 20.0],
    )
    out = run("vapour_force", backend, a, dt=0.01, drag=0.0)
    grad = 45 / (np.pi * (0.9 * R) ** 6) * (0.9 * R - D) ** 2
    f = M * (3.0 + 1.0) / 2 * grad / np.array([0.8, 0.5])  # per the partner's density
    rel = 10 * rounding(precision)[0]
    assert out["vapour_push"] == pytest.approx(f, rel=rel)
    assert out["velocity"][1] == pytest.approx(0.01 * f / [0.5, 0.8] * [-1, 1], rel=rel)
    assert (out["velocity"][[0, 2]] == 0).all() and out["velocity"][1].sum() == pytest.approx(0, abs=rel)


@everywhere
@both
def test_buoyancy_and_drag_by_hand(backend, precision):
    """Alone: v := (v + dt b (T - T_air))/(1 + drag dt); cold vapour sinks; liquid keeps its velocity."""
    a = pool(
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [VAPOUR, VAPOUR, LIQUID], precision, velocity=[[0.4] * 3, [0] * 3, [0.1] * 3],
        temperature=[100, 10, 100], vapour_density=[0.5] * 3, vapour_pressure=[2.0] * 3, vapour_support=[R, R, 0],
    )
    out = run("vapour_force", backend, a, dt=0.05)
    want = np.array([[0.4, 0, 0.1 + 0.05 * 0.03 * 80], [0.4, 0, 0.1 - 0.05 * 0.03 * 10]]) / 1.05
    assert out["velocity"][:, :2].T == pytest.approx(want, rel=rounding(precision)[0])
    assert out["velocity"][:, 2] == pytest.approx([0.4, 0, 0.1]) and (out["vapour_push"] == 0).all()


@everywhere
@both
def test_pressure_conserves_momentum(backend, precision):
    """A crowd with three at one place, walls and liquid in between: finite, and m v sums to nothing."""
    rng = np.random.default_rng(16)
    x = rng.uniform(0, 4 * D, (83, 3))
    x[1] = x[2] = x[0]
    phase = rng.choice([VAPOUR, VAPOUR, LIQUID, WALL], 83)
    phase[:3] = VAPOUR
    a = pool(x, phase, precision, vapour_support=np.where(phase == VAPOUR, rng.uniform(0.5, 1, 83) * R, 0))
    run("vapour_density", backend, a)
    a["temperature"][:] = 20
    out = run("vapour_force", backend, a, dt=0.01, drag=0.0)
    v = out["velocity"].astype(float)
    assert np.isfinite(v).all() and (v[:, phase == VAPOUR] != 0).mean() > 0.9 and (v[:, phase != VAPOUR] == 0).all()
    assert np.abs(v.sum(axis=1)).max() <= (1e-13 if precision == "double" else 1e-6) * np.abs(v).sum()


@everywhere
@both
def test_move_ages_clamps_and_ends(backend, precision):
    x = [[0.1, 0.2, 0.3], [0.1, 0.2, 0.3], [0.99, 0.2, 0.01], [0.1, 0.2, 0.3]]
    v = [[0.5, 0, 1], [0.5, 0, 1], [0.5, -9, -1], [0.5, 0, 1]]
    a = pool(x, [VAPOUR, VAPOUR, VAPOUR, BUBBLE], precision, velocity=np.array(v).T, age=[0.0, 2.9375, 1.0, 9.0])
    sides = {**FAR, "lower_x": 0.0, "upper_x": 1.0, "lower_z": 0.0}
    out = run("vapour_move", backend, a, dt=0.0625, **sides)
    assert out["phase"].tolist() == [VAPOUR, VAPOUR, VAPOUR, BUBBLE]  # life 3: not beyond it yet
    want = [[0.13125, 0.2, 0.3625], [0.13125, 0.2, 0.3625], [1.0, 0.2 - 9 / 16, 0.0], [0.1, 0.2, 0.3]]
    assert out["position"].T == pytest.approx(np.array(want), rel=rounding(precision)[0])
    assert out["age"].tolist() == [0.0625, 3.0, 1.0625, 9.0]
    assert run("vapour_move", backend, a, dt=0.0625, **sides)["phase"].tolist() == [VAPOUR, INACTIVE, VAPOUR, BUBBLE]


@everywhere
@both
def test_precision_by_hand(backend, precision):
    """(16): maxima over vapour neighbours and itself; where both are 0 the terms count in full."""
    x = [[0, 0, 0], [D, 0, 0], [0, D, 0], [20 * D, 0, 0], [0, 0, D]]
    phase = [VAPOUR, VAPOUR, VAPOUR, VAPOUR, LIQUID]
    a = pool(x, phase, precision, vapour_density=[0.2, 0.8, 0.1, 0, 99], vapour_push=[3, 1, 0, 0, 99], vapour_support=np.full(5, 9.0))
    want = np.array([0.25 * 0.25 + 0.75, 0.25 + 0.75 / 3, 0.4, 1.0, 9 / R]) * R  # the third is at R_min
    out = run("vapour_precision", backend, a, density_share=0.25, minimum_support=0.4 * R)["vapour_support"]
    assert out == pytest.approx(want, rel=rounding(precision)[0])
    out = run("vapour_precision", backend, a, adapt=0)["vapour_support"]
    assert (out[:4] == a["mass"].dtype.type(R)).all() and out[4] == 9


@everywhere
@pytest.mark.parametrize("stage", ["vapour_density", "vapour_force", "vapour_move", "vapour_precision", "vapour_source"])
@pytest.mark.parametrize("n", [0, 2])
def test_without_vapour_nothing_happens(backend, stage, n):
    a = pool(np.arange(3 * n).reshape(n, 3), LIQUID, velocity=np.full((3, n), 0.25))
    before = {name: value.copy() for name, value in a.items()}
    run(stage, backend, a, dt=0.004, step_low=1, step_high=0, first_id=5, served=0)
    assert all((a[name] == value).all() for name, value in before.items())
