"""Pressure, viscosity and coupling of liquid, solids and walls; momentum."""

import numpy as np
import pytest
from liquid_cases import DX, REALS, both, box, everywhere, particles, run, tolerance

V, M = 0.008, 8.0
DW = -1.92 * 8 / (np.pi * 0.5**4)  # W'(0.2) of the cubic spline, h = 0.5


def both_forces(backend, a, **params):
    """Forces of liquid, then of solids on top: what a step does."""
    a = {**a, "force": run("fluid_force", backend, a, **params)["force"]}
    return run("reaction_force", backend, a, **params)["force"]


@everywhere
@both
@pytest.mark.parametrize("partner", (1, 2))
@pytest.mark.parametrize("mirror, size", ((0, 5.006581608), (1, 10.013163216)))
def test_printed_force_of_a_boundary(backend, precision, partner, mirror, size):
    a = particles([[0, 0, 0], [0.2, 0, 0]], [0, partner], precision, pressure=[1000.0, 0.0])
    F = both_forces(backend, a, mirror=mirror)
    assert F[:, 0] == pytest.approx([-size, 0, 0], rel=tolerance(precision) + 1e-9)  # repulsive
    assert F[:, 1] == pytest.approx([size if partner == 1 else 0, 0, 0], rel=tolerance(precision) + 1e-9)


@everywhere
@both
def test_pressure_of_a_liquid_pair(backend, precision):
    a = particles(
        [[0, 0, 0], [0, 0.2, 0]],
        0,
        precision,
        pressure=[700.0, 300.0],
        density=[1010.0, 1020.0],
        mass=[8.0, 4.0],
    )
    s = 700 / 1.01**2 + 300 * (500 / 1020) ** 2
    F = run("fluid_force", backend, a)["force"]
    assert F[:, 0] == pytest.approx([0, V * V * s * DW, 0], rel=tolerance(precision))
    assert np.array_equal(F[:, 0], -F[:, 1])


@everywhere
@both
def test_artificial_viscosity_acts_on_approach_only(backend, precision):
    x = [[0, 0, 0], [0.2, 0, 0]]
    a = particles(x, 0, precision, velocity=[[1.0, -0.5], [3, 3], [0, 0]], density=[1000.0, 1040.0])
    nu = 2 * 0.2 * 0.25 * 10 / 2040
    size = M * M * nu * (1.5 * -0.2) / (0.04 + 0.01 * 0.0625) * DW  # along x_ij/r = -x
    F = run("fluid_force", backend, a, alpha=0.2)["force"]
    assert size > 0
    assert F == pytest.approx(np.array([[-size, size], [0, 0], [0, 0]]), rel=tolerance(precision))
    a["velocity"] = -a["velocity"]
    assert (run("fluid_force", backend, a, alpha=0.2)["force"] == 0).all()


@everywhere
@both
@pytest.mark.parametrize("partner, name", ((1, "solid_friction"), (2, "wall_friction")))
def test_friction_of_a_boundary(backend, precision, partner, name):
    a = particles(
        [[0, 0, 0], [0.2, 0, 0]],
        [0, partner],
        precision,
        velocity=[[2.0, 0.0], [0, 0], [0, 0]],
        volume=[V, 0.77 * V],
        density=[1010.0, 500.0],
    )
    nu = 0.3 * 0.25 * 10 / (2 * 1010)
    size = M * (M * 0.77) * nu * (-0.4) / (0.04 + 0.01 * 0.0625) * DW  # (3'), m_i phi_k
    F = both_forces(backend, a, **{name: 0.3})
    assert F[0, 0] == pytest.approx(-size, rel=tolerance(precision)) and size > 0
    assert F[0, 1] == pytest.approx(size if partner == 1 else 0, rel=tolerance(precision))
    other = "wall_friction" if partner == 1 else "solid_friction"
    assert (both_forces(backend, a, **{other: 0.3}) == 0).all()


@everywhere
@both
def test_gravity_and_who_writes_what(backend, precision):
    phase = np.array([0, 1, 2, 5])
    a = particles(
        np.arange(12).reshape(4, 3), phase, precision, force=np.full((3, 4), 7.0), mass=[1.0, 2, 3, 4]
    )
    g = dict(gravity_x=0.5, gravity_y=-1, gravity_z=-9.75)
    F = run("fluid_force", backend, a, **g)["force"]
    assert F.T == pytest.approx(np.array([[0.5, -1, -9.75], [7, 7, 7], [0, 0, 0], [0, 0, 0]]))
    F = run("reaction_force", backend, a, **g)["force"]
    assert F.T == pytest.approx(np.array([[7, 7, 7], [1, -2, -19.5], [7, 7, 7], [7, 7, 7]]))


def crowd(precision, n=160, seed=3, phases=(0, 1)):
    """A jittered cloud of liquid and solid particles of unequal masses and volumes, one pair coincident."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(0, 1.0, (n, 3))
    x[7] = x[8]
    return particles(
        x,
        rng.choice(phases, n),
        precision,
        velocity=rng.normal(size=(3, n)),
        mass=rng.uniform(0.1, 10, n),
        volume=rng.uniform(0.5, 1.5, n) * V,
        density=rng.uniform(900, 1100, n),
        pressure=rng.uniform(0, 5000, n),
    )


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_momentum_of_liquid_and_solids(backend, precision):
    a = crowd(precision)
    F = both_forces(backend, a, alpha=0.2, solid_friction=0.3, gravity_z=-9.81).astype(float)
    weight = -9.81 * a["mass"].astype(float).sum()
    scale = np.abs(F).sum(axis=1)
    eps = np.finfo(a["mass"].dtype).eps
    assert np.abs(F.sum(axis=1) - [0, 0, weight]).max() <= 20 * eps * scale.max()
    # and it is not trivially so: the parts carry momentum
    assert np.abs(F[:, a["phase"] == 1].sum(axis=1)).max() > 1e-3 * scale.max()


@everywhere
@both
def test_lattice_forces_are_symmetric(backend, precision):
    x = box(5, 5, 5)
    a = particles(x, 0, precision, pressure=np.full(125, 1000.0))
    F = run("fluid_force", backend, a)["force"].reshape(3, 5, 5, 5).astype(float)  # [c, z, y, x]
    size = np.abs(F).max()
    near = 2e-5 if precision == "single" else 1e-12
    assert np.abs(F[:, 2, 2, 2]).max() < near * size
    assert F[0] == pytest.approx(-F[0, :, :, ::-1], abs=near * size)
    assert F[2] == pytest.approx(-F[2, ::-1], abs=near * size)
    assert F[2] == pytest.approx(F[0].transpose(2, 1, 0), abs=near * size)
    assert F[2, -1, 2, 2] > 0.1 * size  # pushed out


@everywhere
@both
def test_still_liquid_between_walls_stays(backend, precision):
    # uniform pressure, mirrored by full walls: no net force, whatever the walls' own pressure says
    x = box(9, 9, 9)
    inner = (np.abs(x - 4.5 * DX) < 1.1 * DX).all(axis=1)
    a = particles(x, np.where(inner, 0, 2), precision, pressure=np.where(inner, 2000.0, -1e9))
    F = run("fluid_force", backend, a, wall_friction=0.1)["force"]
    single = V * V * 4000 * abs(DW)
    assert np.abs(F).max() < (2e-5 if precision == "single" else 1e-12) * single


@everywhere
@both
@pytest.mark.parametrize("pressure, below, above", ((5000, 7000, 3000), (500, 1000, 0), (0, 0, 0)))
@pytest.mark.parametrize("partner", (1, 2))
def test_a_boundary_carries_the_hydrostatic_pressure(backend, precision, partner, pressure, below, above):
    # rho g dz = 1000 * 10 * 0.2 = 2000 Pa, within 0 and 2 p
    for side, expected in ((-0.2, below), (0.2, above), (0.0, pressure)):
        x = [[0, 0, 0], [0 if side else 0.2, 0, side]]
        a = particles(x, [0, partner], precision, pressure=[pressure, 0])
        F = run("fluid_force", backend, a, gravity_z=-10)["force"][:, 0] + [0, 0, 80]
        size = V * V * (pressure + expected) * abs(DW)
        along = 0 if side == 0 else 2
        assert F[along] == pytest.approx(-size if side >= 0 else size, rel=1e-4, abs=1e-4)


@everywhere
@both
def test_hydrostatic_liquid_does_not_sink_along_side_walls(backend, precision):
    x = box(9, 9, 9)
    p = 1e5 - 1000 * 10 * x[:, 2]
    inner = np.abs(x[:, 0] - 4.5 * DX) < 2.6 * DX  # liquid five layers wide between two walls
    a = particles(x, np.where(inner, 0, 2), precision, pressure=np.where(inner, p, 0))
    F = run("fluid_force", backend, a, gravity_z=-10)["force"].reshape(3, 9, 9, 9)  # [c, z, y, x]
    at_walls, amid = F[2, 4, 4, [2, 6]], F[2, 4, 4, 4]
    # what is left is the lattice error of the gradient, which is the same in all columns: no shear
    assert abs(amid) < 0.05 * 80
    assert at_walls == pytest.approx(amid, abs=(0.02 if precision == "single" else 1e-8) * 80)


@everywhere
@both
def test_coincident_and_alone(backend, precision):
    a = particles(
        [[0, 0, 0], [0, 0, 0], [9, 9, 9]],
        [0, 1, 0],
        precision,
        pressure=[1e5, 0, 1e5],
        velocity=np.ones((3, 3)),
    )
    F = both_forces(backend, a, alpha=0.2, gravity_z=-10)
    assert F == pytest.approx(np.array([[0.0] * 3, [0] * 3, [-80] * 3]))


@everywhere
def test_empty(backend):
    assert both_forces(backend, particles(np.zeros((0, 3)))).shape == (3, 0)
