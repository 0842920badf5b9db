"""Motion of nodes of slime, by hand."""

import numpy as np
import pytest
from dfsph_cases import BACKENDS, along, arrays, run

everywhere = pytest.mark.parametrize("backend", BACKENDS)
both = pytest.mark.parametrize("precision", ("single", "mixed", "double"))
STAGES = ("keep_motion", "restore_motion", "drive", "nozzle_hold", "weight", "free_kick", "advect", "slime_bounds")
PHASES = [0, 1, 2, 5, 7]


def near(precision):
    return dict(rel=1e-12, abs=1e-13) if precision == "double" else dict(rel=2e-6, abs=1e-6)


def some(precision, x=None, phase=PHASES, **fields):
    return arrays(np.zeros((len(phase), 3)) if x is None else x, phase, precision, stages=STAGES, **fields)


@everywhere
@both
def test_keep_and_restore(backend, precision):
    rng = np.random.default_rng(1)
    x, v = rng.random((5, 3)), rng.random((3, 5))
    a = some(precision, x, velocity=v, position_kept=np.ones((3, 5)))
    before = {k: a[k].copy() for k in ("position", "velocity")}
    run("keep_motion", backend, a, precision)
    a["position"], a["velocity"] = a["position"] + 1, a["velocity"] + 1
    run("restore_motion", backend, a, precision)
    assert all((a[k] == before[k]).all() and (a[f"{k}_kept"] == before[k]).all() for k in before)


@everywhere
@both
def test_driven_body(backend, precision):
    x = np.array([[1, 1, 1], [2, 1, 1], [1, 3, 1], [1, 1, 1], [1, 1, 1]])
    a = some(
        precision, x, [7, 7, 7, 7, 2], driver=[0, 1, 1, -1, 0], velocity=np.full((3, 5), 9.0),
        driver_motion=np.array([[1, 2, 3, 0, 0, 0, 0, 0, 0, 0], [0.5, 0, 0, 0, 0, 2, 1, 1, 1, 0]]).T,
    )
    v = run("drive", backend, a, precision)["velocity"].T
    # the second body turns at 2/s about z through (1, 1): (1, 0) goes along y, (0, 2) against x
    assert v == pytest.approx(np.array([[1, 2, 3], [0.5, 2, 0], [0.5 - 4, 0, 0], [9, 9, 9], [9, 9, 9]]), **near(precision))


@everywhere
@both
def test_nozzle(backend, precision):
    # outlet at (0, 0, 1), flow downwards, 0.5 back, radius 0.25; the second one covers all of it
    place = np.array([[0, 0, 1, 0, 0, -1, 0.5, 0.25], [0, 0, 1, 0, 0, -1, 0.5, 1.0]]).T
    x = [[0, 0, 1], [0.25, 0, 1.5], [0, 0, 0.99], [0, 0, 1.51], [0, 0.5, 1.2], [0, 0, 1.2], [0.8, 0.8, 1.2]]
    phase = [0, 0, 0, 0, 0, 1, 0]
    a = some(precision, x, phase, nozzle_place=place, nozzle_speed=[2, 3], velocity=np.full((3, 7), 9.0))
    out = run("nozzle_hold", backend, a, precision)
    assert out["held"].tolist() == [1, 1, 0, 0, 1, 0, 0]
    assert out["velocity"][2].tolist() == [-2, -2, 9, 9, -3, 9, 9]
    assert out["velocity"][0].tolist() == [0, 0, 9, 9, 0, 9, 9]


@everywhere
@both
def test_nozzle_across_the_axes(backend, precision):
    u = np.array([0.48, 0.6, -0.64])
    across = np.cross(u, [0, 0, 1]) / np.linalg.norm(np.cross(u, [0, 0, 1]))
    x = [-0.1 * u + 0.29 * across, -0.1 * u + 0.31 * across, 0.01 * u, -0.69 * u, -0.71 * u]
    a = some(precision, x, [0] * 5, nozzle_place=np.array([[0, 0, 0, *u, 0.7, 0.3]]).T, nozzle_speed=[2])
    out = run("nozzle_hold", backend, a, precision)
    assert out["held"].tolist() == [1, 0, 0, 1, 0]
    assert out["velocity"][:, 3] == pytest.approx(2 * u, **near(precision))


@everywhere
def test_no_nozzle_holds_nothing(backend):
    a = some("double", held=[1] * 5, nozzle_place=np.zeros((8, 0)), nozzle_speed=[])
    assert (run("nozzle_hold", backend, a)["held"] == 0).all()


@everywhere
@both
def test_weight_and_kick(backend, precision):
    a = some(precision, mass=[2, 4, 8, 8, 8], mobility=[0.5, 0.25, 1, 1, 1], velocity=np.ones((3, 5)))
    force = run("weight", backend, a, precision)["force"]
    g = np.array([1, -2, -9.81])
    expected = np.array([2 * g, 4 * g, 0 * g, 0 * g, 0 * g])
    assert force.T == pytest.approx(expected, **near(precision))
    a["force"] = np.ones_like(force)
    a["mobility"][0] = 0  # held
    v = run("free_kick", backend, a, precision, dt=0.5)["velocity"]
    assert v.T == pytest.approx(np.array([[1] * 3, [1.125] * 3, [1] * 3, [1] * 3, [1] * 3]), **near(precision))


@everywhere
@both
def test_arrival_starts_from_the_kept_position(backend, precision):
    x = np.full((5, 3), 7.0)
    a = some(precision, x, position_kept=np.ones((3, 5)), velocity=np.tile([[1.0], [2.0], [-3.0]], 5))
    position = run("advect", backend, a, precision, dt=0.25)["position"].T
    moved = [1.25, 1.5, 0.25]
    assert position == pytest.approx(np.array([moved, moved, [7] * 3, [7] * 3, moved]), **near(precision))


@everywhere
@both
def test_arrival_in_a_periodic_box(backend, precision):
    kept = np.array([[0.75, 0.25, -0.5, 2.0, 0.5], [1.0] * 5, [0.0] * 5])
    v = np.array([[1.0, -1.0, 0.0, 3.0, 1.0], [20.0] * 5, [0.0] * 5])
    a = some(precision, phase=[0] * 5, position_kept=kept, velocity=v)
    x = run("advect", backend, a, precision, dt=0.5, **along("x", 1.5, -0.5))["position"]
    # the box is [-0.5, 1.0); 1.25 -> -0.25, -0.25, the lower end stays, 3.5 -> 0.5, the upper end becomes the lower one
    assert x[0].tolist() == [-0.25, -0.25, -0.5, 0.5, -0.5] and (x[1] == 11).all()


@pytest.mark.parametrize("backend", BACKENDS[1:])
@pytest.mark.parametrize("precision", ("single", "double"))
def test_arrival_is_never_outside_the_box_by_rounding(backend, precision):
    rng = np.random.default_rng(4)
    kept = np.concatenate([rng.uniform(-40, 40, 400), [-1e-20, 0.7, -0.7, 1.4, -1e-9, 1e-9, 0.1, 0.8]])
    kept = np.concatenate([kept, np.nextafter(np.float32(0.1 + 0.7 * np.arange(-20, 20)), np.float32(-9))])
    n = len(kept)
    a = some(precision, phase=[0] * n, position_kept=np.array([kept, 0 * kept, 0 * kept]))
    real = a["position"].dtype.type
    x = run("advect", backend, a, precision, dt=0.0, **along("x", 0.7, 0.1))["position"][0]
    assert (x >= real(0.1)).all() and (x < real(0.1) + real(0.7)).all()


@everywhere
@both
def test_bounds(backend, precision):
    affine = np.zeros((9, 3))
    affine[:, 0], affine[4, 1], affine[0, 2] = 1, 2.5, 99
    kept = np.array([[1.0, 0, 0, 0, 0], [0] * 5, [0] * 5])
    velocity = np.array([[3, 9, 9, 9, 0], [4, 0, 0, 0, 0], [0, 0, 0, 0, 0]])
    a = some(
        precision, phase=[0, 1, 2, 5, 0], position_kept=kept, velocity=velocity, apic_phase=[0, 0, 5], apic_affine=affine,
        x=[[2.5, 0, 0], [9, 9, 9], [9, 9, 9], [9, 9, 9], [0, 0.125, 0]],
    )
    bounds = run("slime_bounds", backend, a, precision, dt=0.5)["slime_bounds"].max(axis=1)
    assert bounds == pytest.approx([5, 3, 2], **near(precision))  # 1 + 0.5 (3, 4) - 2.5
    a["apic_phase"][0] = 5
    around = run("slime_bounds", backend, a, precision, dt=0.5, **along("y", 2.0))["slime_bounds"].max(axis=1)
    assert around == pytest.approx([5, 2.5, 0.125], **near(precision))  # 2 is a whole length


@everywhere
@pytest.mark.parametrize("row", range(3))
def test_a_fault_is_the_largest_bound(backend, row):
    a = some("double", phase=[0] * 5, apic_phase=[0, 0], apic_affine=np.zeros((9, 2)))
    a[("velocity", "apic_affine", "position")[row]][1, 1] = np.nan
    found = run("slime_bounds", backend, a, dt=0.5)["slime_bounds"].max(axis=1)
    assert np.isinf(found[row]) and np.isinf(found).sum() == (2 if row == 0 else 1)


@everywhere
@pytest.mark.parametrize("stage", STAGES)
def test_empty(backend, stage):
    a = some("double", np.zeros((0, 3)), [], apic_phase=[], nozzle_speed=[1], nozzle_place=np.ones((8, 1)))
    out = run(stage, backend, a, dt=0.1)
    assert all((v == 0).all() for v in out.values())
