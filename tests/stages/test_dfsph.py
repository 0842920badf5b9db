"""Sources and pressure iterations of DFSPH: by hand, and a solve that has to converge."""

import numpy as np
import pytest
from dfsph_cases import BACKENDS, D, arrays, box, run

from melt.check.compare import stage_function

everywhere = pytest.mark.parametrize("backend", BACKENDS)
both = pytest.mark.parametrize("precision", ("single", "double"))
STAGES = (
    "pair_gradient", "divergence_source", "density_source", "source_mean", "shift_source", "pressure_start",
    "pressure_acceleration", "pressure_update", "pressure_kick", "pressure_keep",
)
DT = 0.01


def near(precision):
    return dict(rel=1e-12, abs=1e-14) if precision == "double" else dict(rel=1e-5, abs=1e-7)


def three(precision="double", **fields):
    """Liquid, liquid and wall in a row, with gradients given: g_01 = 2, g_02 = -3, g_10 = -4."""
    a = arrays([[0, 0, 0], [0.3, 0, 0], [-0.3, 0, 0]], [0, 0, 2], precision, stages=STAGES, **fields)
    assert a["neighbour_index"][0, :2].tolist() == [1, 2] and a["neighbour_count"].tolist() == [2, 1, 0]
    a["pair_gradient"][0, 0, :2] = 2, -3
    a["pair_gradient"][1, 0, :2] = 1, 1
    a["pair_gradient"][0, 1, 0] = -4
    return a


@everywhere
@both
def test_sources(backend, precision):
    v = [[0.5, 0.25, 1], [1, 0, 0], [0, 0, 0]]
    a = three(precision, velocity=v, completed_ratio=[1.25, 0.5, 1], dfsph_factor=[1, 2, 0])
    # D s_0 = 2 (0.5 - 0.25) - 3 (0.5 - 1) + 1 (1 - 0) + 1 (1 - 0), D s_1 = -4 (0.25 - 0.5)
    source = run("divergence_source", backend, a, precision, dt=DT)["compression_source"]
    assert source == pytest.approx([0.04, 0.01, 0], **near(precision))
    source = run("divergence_source", backend, a, precision, dt=DT, fewest=2)["compression_source"]
    assert source == pytest.approx([0.04, -1e6, 0], **near(precision))
    source = run("density_source", backend, a, precision, dt=DT)["compression_source"]
    assert source == pytest.approx([0.29, -0.49, 0], **near(precision))


@everywhere
@both
def test_mean_and_shift(backend, precision):
    n = 130
    source, factor = np.arange(n) / 4.0, np.where(np.arange(n) % 3 == 0, 0.0, 1.0)
    source[4] = -1e6  # no pressure by its neighbours: not counted
    a = arrays(np.zeros((n, 3)), 2, precision, stages=STAGES, compression_source=source, dfsph_factor=factor)
    sums = run("source_mean", backend, a, precision)["source_sums"]
    counted = (factor > 0) & (np.arange(n) != 4)
    assert sums[0].sum() == source[counted].sum() and sums[1].sum() == counted.sum()
    assert sums[1, 0] == 1 and sums[0, 0] == source[1]  # share 0 has the particles 0 and 1
    moved = run("shift_source", backend, a, precision, shift=0.5)["compression_source"]
    assert moved == pytest.approx(source - 0.5, **near(precision))
    a["compression_source"][7] = np.nan
    assert np.isnan(run("source_mean", backend, a, precision)["source_sums"][0].sum())


@everywhere
@both
def test_start(backend, precision):
    # half the last pressure; at most ten times the source times the factor; none for a negative source or no factor
    a = arrays(
        np.zeros((5, 3)), 2, precision, stages=STAGES, compression_source=[0.5, 0.01, -0.5, 0.5, np.nan],
        dfsph_factor=[1, 1, 1, 0, 1], density_impulse=[4, 4, 4, 4, 4],
    )
    p = run("pressure_start", backend, a, precision, dt=DT)["solver_pressure"]
    assert p == pytest.approx([2e4, 1e3, 0, 0, 0], rel=1e-5)


@everywhere
@both
def test_acceleration(backend, precision):
    a = three(precision, volume=[2, 3, 5], mobility=[0.5, 0.25, 0], solver_pressure=[10, 4, 0])
    out = run("pressure_acceleration", backend, a, precision)["pressure_acceleration"]
    # a_0 = -0.5 * 2 ((10 + 4) (2, 1) + (10 + 0) (-3, 1)), a_1 = -0.25 * 3 (4 + 10) (-4, 0)
    assert out.T == pytest.approx(np.array([[2, -24, 0], [42, 0, 0], [0, 0, 0]]), **near(precision))


@everywhere
@both
def test_update(backend, precision):
    acceleration = [[100, 50, 0], [0, 10, 7], [0, 0, 0]]
    a = three(
        precision, pressure_acceleration=acceleration, compression_source=[0.08, 0.01, 0.5],
        dfsph_factor=[0.1, 0.2, 0], solver_pressure=[5, 7, 3],
    )
    out = run("pressure_update", backend, a, precision, dt=DT)
    # r_0 = 0.08 + 1e-4 (2 * 50 - 3 * 100 + (0 - 10) + (0 - 7)), r_1 = 0.01 + 1e-4 (-4 * -50)
    r = np.array([0.08 - 0.0217, 0.01 + 0.02])
    assert out["solver_pressure"] == pytest.approx([5 + 0.5 * r[0] * 1e3, 7 + 0.5 * r[1] * 2e3, 0], rel=2e-5)
    assert out["compression_left"] == pytest.approx([*r, 0], rel=2e-5)
    error = out["pressure_error"]
    assert error[0].sum() == pytest.approx(r.sum(), rel=2e-5) and error[1].max() == pytest.approx(r[0], rel=2e-5)
    assert error[2].sum() == 2


@everywhere
@both
def test_update_clamps_skips_and_keeps_a_fault_visible(backend, precision):
    a = arrays(
        np.zeros((4, 3)), 2, precision, stages=STAGES, compression_source=[-0.5, -1e6, np.nan, 0.25],
        dfsph_factor=[1, 1, 1, 1], solver_pressure=[1, 2, 3, 4],
    )
    out = run("pressure_update", backend, a, precision, dt=0.5)
    p, left, error = out["solver_pressure"], out["compression_left"], out["pressure_error"]
    assert p[[0, 1, 3]] == pytest.approx([0, 0, 4.5]) and np.isnan(p[2])
    assert left[[0, 1, 3]].tolist() == [0, 0, 0.25] and np.isinf(left[2])
    assert np.isinf(error[0].sum()) and np.isinf(error[1].max()) and error[2].sum() == 3


@everywhere
@both
def test_kick_and_keep(backend, precision):
    a = three(precision, pressure_acceleration=np.arange(9).reshape(3, 3), velocity=np.ones((3, 3)), solver_pressure=[5, 0, 2])
    velocity = run("pressure_kick", backend, a, precision, dt=0.5)["velocity"]
    assert (velocity == 1 + 0.5 * np.arange(9).reshape(3, 3)).all()
    assert run("pressure_keep", backend, a, precision, dt=0.5)["density_impulse"].tolist() == [1.25, 0, 0.5]


@everywhere
@pytest.mark.parametrize("stage", [s for s in STAGES if s != "pair_gradient"])
def test_empty(backend, stage):
    out = run(stage, backend, arrays(np.zeros((0, 3)), 0, stages=STAGES), dt=DT, shift=0.1)
    assert all((v == 0).all() for v in out.values())


def squeezed(precision="double", spacing=0.96 * D):
    """Unequal liquid particles, some solid, too close, beside a wall: s is above 1 inside."""
    rng = np.random.default_rng(5)
    x = box(6, spacing) + rng.uniform(-0.01, 0.01, (216, 3))
    phase = np.where(x[:, 0] < 1.2 * spacing, 2, np.where(rng.random(216) < 0.1, 1, 0))
    volume = D**3 * rng.uniform(0.9, 1.1, 216)
    a = arrays(x, phase, precision, stages=STAGES, volume=volume, mass=1000 * volume)
    run("pair_gradient", "cpu", a, precision)
    a["completed_ratio"] = a["density_ratio"].copy()
    return a


def solve(a, backend, precision="double", limit=400, eta=1e-4):
    """Return the iterations of a density solve and its error; ``a`` gets the velocity after it.

    The error is that of the acceleration at hand: the kick is by this one, not by that of the pressure after it.
    """
    run("density_source", backend, a, precision, dt=DT)
    run("pressure_start", backend, a, precision, dt=DT)
    iterations, left = 0, np.inf
    while left > eta and iterations < limit:
        run("pressure_acceleration", backend, a, precision)
        error = run("pressure_update", backend, a, precision, dt=DT)["pressure_error"]
        left = error[0].sum() / error[2].sum()
        iterations += 1
    run("pressure_keep", backend, a, precision, dt=DT)
    run("pressure_kick", backend, a, precision, dt=DT)
    return iterations, left


@everywhere
def test_solve_removes_the_compression(backend):
    a = squeezed()
    before = run("density_source", backend, a, dt=DT)["compression_source"].max()
    iterations, left = solve(a, backend)
    after = run("density_source", backend, a, dt=DT)["compression_source"]
    act = a["dfsph_factor"] > 0
    assert before > 0.02 and iterations < 400
    assert np.maximum(after[act], 0).mean() == pytest.approx(left, rel=1e-9) and left <= 1e-4
    assert (a["velocity"][:, a["phase"] == 2] == 0).all()


@everywhere
@both
def test_pair_forces_keep_momentum(backend, precision):
    rng = np.random.default_rng(3)
    x = box(5) + rng.uniform(-0.05, 0.05, (125, 3))
    phase = np.where(rng.random(125) < 0.2, 1, 0)
    volume = D**3 * rng.uniform(0.2, 2, 125)
    mass = rng.uniform(1, 9, 125)
    a = arrays(x, phase, precision, stages=STAGES, volume=volume, mass=mass)
    run("pair_gradient", backend, a, precision)
    a["solver_pressure"] = np.where(phase == 0, rng.uniform(0, 1e4, 125), 0).astype(a["solver_pressure"].dtype)
    run("pressure_acceleration", backend, a, precision)
    force = mass * a["pressure_acceleration"]
    torque = np.cross(a["position"].T.astype(float), force.T)
    small = 1e-12 if precision == "double" else 1e-5
    assert np.abs(force.sum(axis=1)).max() < small * np.abs(force).sum()
    assert np.abs(torque.sum(axis=0)).max() < small * np.abs(torque).sum()
    assert np.abs(force[:, phase == 1]).max() > 0


def test_warm_start_saves_iterations():
    """Of a solve whose source comes again, as in a flow at rest; an old complaint is that it did not."""
    cold, again = squeezed(), squeezed()
    iterations, _ = solve(cold, "cpu")
    again["density_impulse"] = cold["density_impulse"].copy()
    assert solve(again, "cpu")[0] < 0.9 * iterations


def test_stages_exist_everywhere():
    for stage in STAGES:
        for side in ("reference", "cpu", "cuda"):
            assert callable(stage_function(stage, side))
