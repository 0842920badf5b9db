"""Rotation factors: three routines against SciPy, every rank, reflections, undetermined axes."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from melt.physics.polar import horn, iterative, solve_inertia, svd
from melt.physics.quaternion import from_matrix, matrix, rotate

ROUTINES = ["svd", "horn", "iterative"]


def factor(routine, A, previous=(1, 0, 0, 0), real=np.float64):
    """Return (quaternion, matrix) by one of the compiled routines."""
    a = tuple(real(v) for v in np.ravel(A / np.abs(A).max() if np.abs(A).max() > 0 else A))
    q = tuple(real(v) for v in previous)
    if routine == "iterative":
        out = iterative(a, q, real(1e-14 if real is np.float64 else 1e-8), np.int32(30))
    else:
        out = (svd if routine == "svd" else horn)(a, q)
    return np.array(out), np.array(matrix(*(real(v) for v in out))).reshape(3, 3)


def quaternion(rotation):
    x, y, z, w = rotation.as_quat()
    return np.array([w, x, y, z])


def tolerance(real):
    return 1e-13 if real is np.float64 else 3e-6


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("routine", ROUTINES)
def test_full_rank_equals_the_svd_with_the_determinant_rule(routine, real):
    rng = np.random.default_rng(1)
    for _ in range(300):
        A = rng.normal(size=(3, 3))
        U, s, Vt = np.linalg.svd(A)
        sign = np.sign(np.linalg.det(U @ Vt))
        R = U @ np.diag([1, 1, sign]) @ Vt
        gap = (s[1] + sign * s[2]) / s[0]
        q, got = factor(routine, A, real=real)
        assert np.abs(got - R).max() <= tolerance(real) / min(1, gap)
        assert np.linalg.det(got) == pytest.approx(1, abs=1e-5)
        assert q[0] >= 0 and q @ q == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("routine", ROUTINES)
def test_plates_have_one_rotation(routine, real):
    rng = np.random.default_rng(2)
    for turn in Rotation.random(50, random_state=3):
        X = rng.normal(size=(3, 6)) * [[1.0], [0.7], [0.0]]
        R = turn.as_matrix()
        assert np.abs(factor(routine, R @ X @ X.T, real=real)[1] - R).max() <= 20 * tolerance(real)


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("routine", ROUTINES)
def test_a_rod_takes_the_rotation_nearest_to_the_last_one(routine, real):
    axis = np.array([1.0, 0.0, 0.0])
    before = Rotation.from_rotvec([0.4, 0.2, -0.3])
    now = Rotation.from_rotvec([0.1, 0.3, 0.5]) * before
    A = np.outer(now.apply(axis), axis)
    _, R = factor(routine, A, quaternion(before), real)
    assert np.abs(R @ axis - now.apply(axis)).max() <= 5 * tolerance(real)
    # the shortest turn that carries the old axis to the new one
    a, b = before.apply(axis), now.apply(axis)
    shortest = (
        Rotation.from_rotvec(np.cross(a, b) / np.linalg.norm(np.cross(a, b)) * np.arccos(a @ b)) * before
    )
    assert np.abs(R - shortest.as_matrix()).max() <= 10 * tolerance(real)


@pytest.mark.parametrize("routine", ROUTINES)
def test_nothing_to_match_keeps_the_rotation(routine):
    before = quaternion(Rotation.from_rotvec([0.4, 0.2, -0.3]))
    assert factor(routine, np.zeros((3, 3)), before)[0] == pytest.approx(before, abs=1e-14)


@pytest.mark.parametrize("routine", ROUTINES)
def test_mirror_images_give_proper_rotations(routine):
    """A = -S: a half turn about the axis of the smallest singular value, never a reflection."""
    q, R = factor(routine, -np.diag([3.0, 2.0, 1.0]))
    assert np.abs(R - np.diag([-1.0, -1.0, 1.0])).max() <= 1e-13
    # of all half turns of an inverted cube none is better: still a finite proper rotation
    assert np.linalg.det(factor(routine, -np.eye(3))[1]) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("angle", [3.0, np.pi - 1e-9, np.pi])
def test_the_iteration_escapes_half_turns(angle):
    for axis in (np.array([0.0, 0, 1]), np.array([0.6, -0.8, 0])):
        R = Rotation.from_rotvec(angle * axis).as_matrix()
        assert np.abs(factor("iterative", R @ np.diag([1.0, 1.1, 0.9]))[1] - R).max() <= 1e-12


@pytest.mark.parametrize("start", [0.006, 0.1, 1.0])
def test_the_iteration_converges_quadratically(start):
    """From 0.1 rad the fixed-point form needs 24-47 steps to 1e-12; this one at most 4."""
    rng = np.random.default_rng(4)
    steps = {0.006: 2, 0.1: 3, 1.0: 6}[start]
    for turn in Rotation.random(50, random_state=5):
        axis = rng.normal(size=3)
        begin = turn * Rotation.from_rotvec(start * axis / np.linalg.norm(axis))
        R = turn.as_matrix()
        A = tuple(np.ravel(R @ np.diag([1.0, 0.8, 0.6]) / 3))
        few = iterative(A, tuple(quaternion(begin)), np.float64(1e30), np.int32(1))  # one step only
        many = iterative(A, tuple(quaternion(begin)), np.float64(1e-9), np.int32(steps))
        assert np.abs(np.array(matrix(*many)).reshape(3, 3) - R).max() <= 1e-10
        if start == 0.1:
            assert np.abs(np.array(matrix(*few)).reshape(3, 3) - R).max() <= 0.02


def test_quaternions_and_matrices():
    for turn in Rotation.random(100, random_state=6):
        q = from_matrix(*(float(v) for v in turn.as_matrix().ravel()))
        assert np.array(matrix(*q)).reshape(3, 3) == pytest.approx(turn.as_matrix(), abs=1e-14)
        assert np.array(rotate(*q, 1.0, -2.0, 0.5)) == pytest.approx(turn.apply([1, -2, 0.5]), abs=1e-14)


def test_spin_of_rods_and_points():
    omega = solve_inertia((0.0, 2.0, 2.0, 0.0, 0.0, 0.0), (5.0, 4.0, -2.0))
    assert np.array(omega) == pytest.approx([0, 2, -1], abs=1e-15)
    assert np.array(solve_inertia((0.0,) * 6, (1.0, 1.0, 1.0))) == pytest.approx([0, 0, 0])
    rng = np.random.default_rng(7)
    B = rng.normal(size=(3, 3))
    inertia, omega = B @ B.T + np.eye(3), rng.normal(size=3)
    six = tuple(float(inertia[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    assert np.array(solve_inertia(six, tuple(float(v) for v in inertia @ omega))) == pytest.approx(
        omega, rel=1e-12
    )
