"""Weakly compressible SPH, the baseline of boiling's Table 1 (boiling spec 1)."""

import numpy as np
import pytest
from liquid_cases import REALS, both, everywhere, rows_of
from pbf_cases import D, lattice

from melt import params as P
from melt.check.compare import run_stage
from melt.position_based import lattice_sums
from melt.stages import STAGES

RATIO = 2.2
R = RATIO * D
STIFFNESS, VISCOSITY = 1.6e5, 3.0


def arrays(x, phase=0, precision="double", **fields):
    """Return the fields of these stages for particles at x (n, 3), with brute-force lists within R."""
    real, place = REALS[precision]
    x = np.asarray(x, float).reshape(-1, 3)
    n = len(x)
    phase = np.broadcast_to(np.asarray(phase, np.int32), n).copy()
    count, index = rows_of(x, phase, R)
    given = dict(rest_volume=np.full(n, D**3), velocity=np.zeros((3, n)), velocity_next=np.zeros((3, n)))
    given.update({name: np.zeros(n) for name in ("density", "pressure", "constraint")}, **fields)
    a = {name: np.ascontiguousarray(value, dtype=real) for name, value in given.items()}
    return dict(a, position=np.ascontiguousarray(x.T, dtype=place), phase=phase, neighbour_count=count, neighbour_index=index)


def run(stage, backend, a, **scalars):
    """Run a stage, put what it writes into ``a`` and return that."""
    real = a["rest_volume"].dtype.type
    values = dict(support=R, rest_density=1000.0, stiffness=STIFFNESS, viscosity=VISCOSITY)
    given = {"sph": P.make(P.Sph, real, **{**values, **{k: v for k, v in scalars.items() if k in values}})}
    if "dt" in scalars:
        given["dt"] = real(scalars["dt"])
    out = run_stage(stage, backend, a, {p: given[p] for p in STAGES[stage].params})
    a.update(out)
    return out


def sized(precision):
    return 5e-6 if precision == "single" else 1e-12


@everywhere
@both
def test_pair_by_hand(backend, precision):
    """Two particles of unequal volume at R/2, one of them compressed: density, pressure and both accelerations."""
    V = np.array([8.0, 2.0]) * D**3
    v = np.array([[0.3, -0.1], [0.0, 0.2], [0.1, 0.0]])
    a = arrays([[0, 0, 0], [R / 2, 0, 0]], 0, precision, rest_volume=V, velocity=v)
    run("sph_density", backend, a)
    W0 = 315 / (64 * np.pi * R**3)
    W1 = W0 * 0.75**3
    rho = 1000 * (V * W0 + V[::-1] * W1)
    assert rho[0] > 1000 > rho[1]
    rel = sized(precision)
    assert a["density"] == pytest.approx(rho, rel=rel)
    assert a["constraint"] == pytest.approx(rho / 1000 - 1, rel=rel, abs=rel)
    assert a["pressure"] == pytest.approx([STIFFNESS * (rho[0] / 1000 - 1), 0], rel=4 * rel)
    run("sph_force", backend, a, dt=1e-3)
    volume = 1000 * V / rho
    half = STIFFNESS * (rho[0] / 1000 - 1) / 2
    grad, lap = 45 / (np.pi * R**4) / 4, 45 / (np.pi * R**5) / 2
    # the left one is pushed to the left
    acc = volume[::-1] / rho * (half * grad * np.array([[-1, 1], [0, 0], [0, 0]]) + VISCOSITY * lap * (v[:, ::-1] - v))
    assert (a["velocity_next"] - v) == pytest.approx(1e-3 * acc, rel=20 * rel, abs=rel * 0.3)


@everywhere
@both
def test_partners_that_are_not_liquid(backend, precision):
    """A wall mirrors the pressure and drags, a bubble mirrors and slips, vapour and free slots are not there."""
    r = R / 2
    grad, lap = 45 / (np.pi * R**4) / 4, 45 / (np.pi * R**5) / 2
    pushes, rel = {}, sized(precision)
    for phase in (1, 2, 3, 4, 5):
        V = np.array([8.0, 2.0]) * D**3
        v = np.array([[0.0, 0], [0.4, 0.1], [0, 0]])
        a = arrays([[0, 0, 0], [r, 0, 0]], [0, phase], precision, rest_volume=V, velocity=v)
        run("sph_density", backend, a)
        there = phase <= 3
        n = 315 / (64 * np.pi * R**3) * (V[0] + V[1] * 0.75**3 * there)
        assert a["density"] == pytest.approx([1000 * n, 1000], rel=rel)
        assert a["constraint"] == pytest.approx([n - 1, 0], rel=4 * rel) and a["pressure"][1] == 0
        out = run("sph_force", backend, a, dt=1e-3)["velocity_next"]
        drag = VISCOSITY * lap * 0.3 if phase < 3 else 0.0
        push = -V[1] / (1000 * n) * np.array([STIFFNESS * (n - 1) * grad, drag, 0]) * there
        assert out[:, 0] - v[:, 0] == pytest.approx(1e-3 * push, rel=20 * rel, abs=rel * 0.4)
        assert out[:, 1].tolist() == a["velocity"][:, 1].tolist()
        pushes[phase] = out[:, 0] - a["velocity"][:, 0]
    assert pushes[3][1] == 0 and pushes[2][1] < 0 and pushes[3][0] == pytest.approx(pushes[2][0], rel=1e-6)
    assert (pushes[4] == 0).all() and (pushes[5] == 0).all()


@everywhere
@both
def test_momentum_of_free_liquid(backend, precision):
    """Sum m a = 0 over a cloud of unequal volumes, some of it compressed, two at one place."""
    rng = np.random.default_rng(3)
    n = 203
    x = rng.uniform(0, 1, (n, 3)) * np.array([9, 4, 4]) * D
    x[1] = x[0]
    V = rng.uniform(0.5, 2, n) * D**3
    a = arrays(x, 0, precision, rest_volume=V, velocity=rng.normal(size=(3, n)))
    run("sph_density", backend, a)
    assert (a["pressure"] > 0).sum() > 50 and (a["pressure"] == 0).sum() > 10
    out = run("sph_force", backend, a, dt=1e-3)["velocity_next"]
    impulse = V * (out.astype(float) - a["velocity"])
    assert np.isfinite(out).all() and np.abs(impulse).max() > 0
    assert np.abs(impulse.sum(axis=1)).max() <= (1e-6 if precision == "single" else 1e-14) * np.abs(impulse).sum()


@everywhere
@both
def test_lattice_at_rest(backend, precision):
    """Inside a lattice C is the lattice sum of poly6 less 1 (raw kernels), and nothing moves; the rim is pushed out."""
    x = lattice(9)
    a = arrays(x, 0, precision)
    run("sph_density", backend, a)
    out = run("sph_force", backend, a, dt=1e-3)["velocity_next"]
    depth = np.minimum(x, 9 * D - x).min(axis=1) / D
    S = lattice_sums(RATIO).value
    assert a["constraint"][depth > 2] == pytest.approx(S - 1, rel=1e-4 if precision == "single" else 1e-11)
    still = np.abs(out[:, depth > 4]).max()  # float32: 32 pushes that cancel, each to ulp(x)/d = 4e-7
    assert still <= (3e-5 if precision == "single" else 1e-13) * np.abs(out).max()
    edge = (depth < 2.2) & (depth > 1.2) & (np.abs(x - 4.5 * D).max(axis=1) > 2.4 * D)
    assert (np.einsum("ij,ij->j", out[:, edge], (x[edge] - 4.5 * D).T) > 0).any()


@everywhere
def test_viscosity_slows_shear_and_leaves_uniform_motion(backend):
    x = lattice(6)
    a = arrays(x, 0, "double", velocity=np.tile([[0.7], [-0.2], [0.1]], (1, len(x))))
    run("sph_density", backend, a)
    a["pressure"][:] = 0
    assert (run("sph_force", backend, a, dt=1e-3)["velocity_next"] == a["velocity"]).all()
    a["velocity"][0] = np.sign(x[:, 2] - 3 * D)
    out = run("sph_force", backend, a, dt=1e-4)["velocity_next"]
    assert (np.abs(out[0]) <= 1).all() and (np.abs(out[0]) < 1).any()
    assert (run("sph_force", backend, a, dt=1e-4, viscosity=0.0)["velocity_next"] == a["velocity"]).all()


@everywhere
def test_nothing_is_fine(backend):
    a = arrays(np.zeros((0, 3)))
    run("sph_density", backend, a)
    run("sph_force", backend, a, dt=1e-3)
