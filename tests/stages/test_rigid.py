"""Rigid-component baseline: poses, forces, momentum; splits by melting."""

import numpy as np
import pytest
from lattice_bodies import DX, Drive, box, lattice
from scipy.spatial.transform import Rotation

from melt.check.compare import difference
from melt.systems.topology import build_lattice, melt_and_relink

BACKENDS = ["reference", "cpu", "cuda"]


pytestmark = pytest.mark.usefixtures("emulated")


def built(cell, backend, body=None, precision="double", **kwargs):
    do = Drive(cell, body, backend=backend, precision=precision, **kwargs)
    rng = np.random.default_rng(1)
    do.set(
        mass=rng.uniform(1, 3, do.sizes["particle"]), force=rng.normal(size=(3, do.sizes["particle"])) * 100
    )
    build_lattice(do)
    return do


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("cells", [box(1, 1, 1), box(4, 1, 1), box(3, 4, 1), box(3, 4, 2)])
def test_rigid_motion_has_no_goal_displacement(cells, backend):
    do = built(cells, backend)
    Q = Rotation.from_rotvec([1.0, 0.4, -2.0]).as_matrix()
    do.set(position=Q @ do["position"] + 5)
    do.rigid_match()
    do.rigid_goal()
    assert np.abs(do["goal"]).max() <= 1e-12 * DX * 10


@pytest.mark.parametrize("backend", BACKENDS)
def test_forces_keep_their_sum_and_torque(backend):
    do = built(box(4, 3, 2), backend)
    F, x, m = do["force"].copy(), do["position"], do["mass"]
    do.rigid_match()
    do.rigid_goal()
    new = do["force"]
    assert new.sum(axis=1) == pytest.approx(F.sum(axis=1), rel=1e-12)
    assert np.cross(x.T, new.T).sum(axis=0) == pytest.approx(np.cross(x.T, F.T).sum(axis=0), rel=1e-11)
    # accelerations are those of one rigid body
    a = new / m
    d = x[:, 1:] - x[:, :1]
    assert np.abs(((a[:, 1:] - a[:, :1]) * d).sum(axis=0)).max() <= 1e-12 * np.abs(a).max()


@pytest.mark.parametrize("backend", BACKENDS)
def test_uniform_gravity_on_two_components(backend):
    do = built(box(5, 2, 2), backend, body=np.repeat([0, 1], [8, 12]))
    do.set(force=np.array([[0.0], [0.0], [-9.81]]) * do["mass"])
    do.rigid_match()
    roots = np.unique(do["site_component"])
    assert roots.tolist() == [0, 8]
    assert do["component_push"][:, roots] == pytest.approx(
        np.array([[0.0, 0.0], [0.0, 0.0], [-9.81, -9.81]]), abs=1e-12
    )
    assert do["component_twist"][:, roots] == pytest.approx(np.zeros((3, 2)), abs=1e-11)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("rotation", [0, 1, 2])
def test_backends_agree_after_a_split(precision, rotation):
    scales = {"spacing": DX, "one": 1.0, "force": 100.0, "acceleration": 100.0, "rate2": 100.0}
    runs = []
    for backend in BACKENDS:
        do = built(
            box(7, 3, 3), backend, precision=precision, lattice_params=lattice(precision, rotation=rotation)
        )
        do.heat(np.flatnonzero(do["site_cell"][0] == 3))
        melt_and_relink(do)
        do.heat(np.flatnonzero(do["site_cell"][0] == 3))
        melt_and_relink(do)
        assert np.unique(do["site_component"]).size == 3
        do.set(position=do["position"] + np.random.default_rng(2).normal(size=(3, 63)) * 0.03 * DX)
        do.rigid_match()
        do.rigid_goal()
        runs.append(do)
    for do in runs[1:]:
        for stage, fields in (
            (
                "rigid_match",
                [
                    "component_centre",
                    "component_rest",
                    "component_rotation",
                    "component_push",
                    "component_twist",
                ],
            ),
            ("rigid_goal", ["force", "goal"]),
        ):
            for field in fields:
                worst = difference(stage, field, runs[0][field], do[field], precision, scales)
                assert worst.ratio <= 1, (do.backend, worst)


@pytest.mark.parametrize("backend", ["cpu"])
def test_a_free_body_tumbles_rigidly(backend):
    """An unequal box, 400 steps: momentum exact, shape to (omega dt)^2 / 2 of one step."""
    do = built(box(5, 3, 2), backend)
    do.set(force=np.zeros((3, 30)))
    m, dt = do["mass"], 1e-3
    x = do["position"] - (do["mass"] * do["position"]).sum(axis=1, keepdims=True) / do["mass"].sum()
    rest = np.linalg.norm(x[:, :, None] - x[:, None, :], axis=0)
    spin = np.array([3.0, 1.0, 5.0])
    v = np.cross(spin, x.T).T
    start, energy = np.cross(x.T, (m * v).T).sum(axis=0), (m * v * v).sum()
    for _ in range(400):
        do.set(position=x)
        do.rigid_match()
        do.rigid_goal()
        v = v + do["goal"] / dt
        x = x + dt * v
    assert np.abs(np.cross(x.T, (m * v).T).sum(axis=0) - start).max() <= 1e-11 * np.abs(start).max()
    assert np.abs(x @ m).max() <= 1e-12 * m.sum()
    now = np.linalg.norm(x[:, :, None] - x[:, None, :], axis=0)
    # the centripetal correction of a step is one step late: strain about (omega dt)^2
    assert np.abs(now - rest).max() <= 5 * (spin @ spin) * dt**2 * rest.max()
    assert abs((m * v * v).sum() / energy - 1) <= 1e-3
