"""Surface field: hand-computed values, then the three versions on the check inputs."""

import numpy as np
import pytest

from melt import params as P
from melt.check.compare import compare_stage, run_stage
from melt.check.inputs import choices, make
from melt.physics.reconstruction import eigenvalue_correction, largest_eigenvalue

BACKENDS = ("reference", "cpu", "cuda")


pytestmark = pytest.mark.usefixtures("emulated")


def inputs(x, nodes, T=None, real=np.float64, **values):
    """One cell of edge 4 holds all particles; reach 2, radius 0.6."""
    x, nodes = (np.ascontiguousarray(np.array(a, real).reshape(-1, 3).T) for a in (x, nodes))
    values = dict(reach=2.0, radius=0.6, correct=0, temperature=int(T is not None)) | values
    grid = dict(origin_x=-2.0, origin_y=-2.0, origin_z=-2.0, inverse_cell=0.25, nx=1, ny=1, nz=1)
    n, m = x.shape[1], nodes.shape[1]
    arrays = dict(
        position=x, temperature=np.zeros(0, real) if T is None else np.array(T, real),
        cell_start=np.array([0, n, n], np.int32), surface_node=nodes,
        surface_distance=np.zeros(m, real), surface_temperature=np.zeros(m, real),
    )
    reconstruction = P.make(P.Reconstruction, real, **values)
    return arrays, {"grid": P.make(P.Grid, real, **grid), "reconstruction": reconstruction}


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("backend", BACKENDS)
def test_hand_computed(backend, real):
    """One particle at the origin: phi = |x| - 0.6, cut at 0.6. Then two at x = 0 and 1, seen from 0.5 and 0.

    From (0, 0, 0) they weigh 1 and (3/4)^3 = 27/64: the mean is 27/91 away and T = (10 64 + 30 27)/91.
    """
    out = run_stage("surface_field", backend, *inputs(
        [(0, 0, 0)], [(0, 0, 0), (0.5, 0, 0), (0, -1, 0), (0, 0, 1.5), (2, 0, 0), (9, 9, 9)], [7.0], real))
    assert np.allclose(out["surface_distance"], [-0.6, -0.1, 0.4, 0.6, 0.6, 0.6], atol=1e-6)
    assert np.allclose(out["surface_temperature"], [7, 7, 7, 7, 0, 0], rtol=1e-6)
    out = run_stage("surface_field", backend, *inputs(
        [(0, 0, 0), (1, 0, 0)], [(0.5, 0, 0), (0, 0, 0)], [10.0, 30.0], real))
    assert np.allclose(out["surface_distance"], [-0.6, 27 / 91 - 0.6], atol=1e-6)
    assert np.allclose(out["surface_temperature"], [20.0, (640 + 810) / 91], rtol=1e-6)
    # no temperature: an array of length 0 that is not looked at
    out = run_stage("surface_field", backend, *inputs([(0, 0, 0)], [(0, 0, 0)], None, real))
    assert out["surface_temperature"] == [0]


@pytest.mark.parametrize("backend", BACKENDS)
def test_correction_between_two_particles(backend):
    """Half-way between particles at x = -a and a, dxbar/dx = 2 a^2 g/(2 w) with g/w = 6/(R^2 - a^2) is
    6 a^2/(R^2 - a^2): for a = 1 it is EV = 2, so f = g^3 - 3 g^2 + 3 g with g = 1.5/3.1."""
    out = run_stage("surface_field", backend, *inputs([(-1, 0, 0), (1, 0, 0)], [(0, 0, 0)], correct=1))
    g = 1.5 / 3.1
    assert out["surface_distance"] == pytest.approx(-0.6 * (g**3 - 3 * g**2 + 3 * g), rel=1e-9)
    # a = 1.5: EV = 13.5/1.75 > 3.5, so f = 0 and the sheet is gone
    out = run_stage("surface_field", backend, *inputs([(-1.5, 0, 0), (1.5, 0, 0)], [(0, 0, 0)], correct=1))
    assert out["surface_distance"] == pytest.approx(0, abs=1e-12)
    # a = 0.4: EV = 0.96/3.84 = 0.25 < 0.4, so f = 1
    out = run_stage("surface_field", backend, *inputs([(-0.4, 0, 0), (0.4, 0, 0)], [(0, 0, 0)], correct=1))
    assert out["surface_distance"] == pytest.approx(-0.6, rel=1e-9)


def test_scalar_formulas():
    rng = np.random.default_rng(2)
    for _ in range(200):
        A = rng.normal(size=(3, 3))
        A = A + A.T
        got = largest_eigenvalue(A[0, 0], A[1, 1], A[2, 2], A[0, 1], A[0, 2], A[1, 2])
        assert got == pytest.approx(np.linalg.eigvalsh(A)[-1], abs=1e-12)
    assert largest_eigenvalue(2.0, 2.0, 2.0, 0.0, 0.0, 0.0) == 2.0 and largest_eigenvalue(*[0.0] * 6) == 0.0
    assert largest_eigenvalue(1.0, 5.0, 5.0, 0.0, 0.0, 0.0) == pytest.approx(5.0, abs=1e-7)
    assert [eigenvalue_correction(v) for v in (-1.0, 0.4, 3.5, 9.0)] == pytest.approx([1, 1, 0, 0], abs=1e-12)


@pytest.mark.parametrize("precision", ["single", "mixed", "double"])
@pytest.mark.parametrize("choice", choices("surface_field"), ids=str)
def test_twins_against_the_reference(precision, choice):
    arrays, params, scales = make("surface_field", precision, seed=3, choice=choice)
    for pair in (("reference", "cpu"), ("reference", "cuda"), ("cpu", "cuda")):
        for worst in compare_stage("surface_field", pair, arrays, params, precision, scales).values():
            assert worst.ratio <= 1, (pair, worst)
