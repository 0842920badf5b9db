"""Velocity filters of the position based fluid (boiling V12, V13)."""

import numpy as np
import pytest
from liquid_cases import both, everywhere
from pbf_cases import MASS, D, arrays, lattice, pbf_tuple, run


@everywhere
@both
def test_rigid_rotation_has_vorticity_of_twice_the_spin(backend, precision):
    """V13."""
    spin = np.array([0.3, -1.2, 0.7])
    x = lattice(7)
    v = np.cross(spin, x - 3.5 * D)
    for uniform in (1, 0):
        a = arrays(x, 0, precision, velocity=v.T)
        run("vorticity_curl", backend, a, pbf_tuple(real=a["mass"].dtype.type, uniform=uniform))
        inside = (np.abs(x - 3.5 * D) < 1.1 * D).all(axis=1)
        error = np.abs(a["vorticity"][:, inside].T - 2 * spin).max()
        assert inside.sum() == 27 and error <= (1e-12 if precision == "double" else 1e-5)


@everywhere
def test_confinement_by_hand(backend):
    """v += dt eps N x omega, N along the growth of |omega|: from the slow particle to the fast one."""
    a = arrays([[0, 0, 0], [D, 0, 0]], vorticity=[[0.0, 0], [1, 3], [0, 0]])
    v = run("vorticity_force", backend, a, pbf_tuple(vorticity=0.05), dt=0.01)["velocity"]
    # N = (1, 0, 0) for both: grad W points to the partner, and the difference of |omega| changes sign with it
    assert v.T == pytest.approx(0.01 * 0.05 * np.array([[0, 0, 1], [0, 0, 3]]), rel=1e-6, abs=1e-15)
    still = arrays(lattice(3))
    assert (run("vorticity_force", backend, still, pbf_tuple(vorticity=0.05), dt=0.01)["velocity"] == 0).all()


@everywhere
def test_blend_of_a_pair_by_hand(backend):
    m = np.array([1.0, 3.0, 1.0]) * MASS
    a = arrays([[0, 0, 0], [D, 0, 0], [0, D, 0]], [0, 0, 2], mass=m, velocity=[[0.0, 1, 9], [0, 0, 9], [0, 0, 9]])
    v = run("pbf_xsph", backend, a, pbf_tuple(blend=12.0), dt=0.005)["velocity_next"]
    W = 315 / (64 * np.pi * 2.2**3) * (1 - 1 / 2.2**2) ** 3  # V W
    assert v[0] == pytest.approx([0.06 * 2 * 0.75 * W, 1 - 0.06 * 2 * 0.25 * W, 9], rel=1e-12)
    fast = run("pbf_xsph", backend, a, pbf_tuple(blend=1e6), dt=0.005)["velocity_next"]
    assert fast[0, 0] == pytest.approx(0.5 * 2 * 0.75 * W, rel=1e-12)  # c is at most 0.5


@everywhere
def test_shear_wave_decays_by_the_discrete_factor(backend):
    """V12: 1 - c sum V W1 (1 - cos k dz), exact; as a viscosity c M2 R^2/(6 dt) with M2 = 0.282 within 2 %."""
    n, c = 32, 0.05
    x = lattice(7, 7, n + 6)
    k = 2 * np.pi / (n * D)
    wave = np.cos(k * (x[:, 2] - 3 * D))
    a = arrays(x, velocity=np.array([wave, 0 * wave, 0 * wave]))
    out = run("pbf_xsph", backend, a, pbf_tuple(blend=c / 0.01), dt=0.01)["velocity_next"][0]
    middle = (np.abs(x[:, :2] - 3.5 * D) < 0.1 * D).all(axis=1) & (x[:, 2] > 3 * D) & (x[:, 2] < (n + 3) * D)
    offset = np.indices((7, 7, 7)).reshape(3, -1).T - 3
    r = np.sqrt((offset**2).sum(axis=1)) / 2.2
    W = 315 / (64 * np.pi * 2.2**3) * np.where(r < 1, 1 - r**2, 0) ** 3
    factor = 1 - c * (W * (1 - np.cos(k * D * offset[:, 2]))).sum()
    assert middle.sum() == n
    assert np.abs(out[middle] - factor * wave[middle]).max() <= 1e-12
    assert (1 - factor) / k**2 == pytest.approx(c * 0.282 * (2.2 * D) ** 2 / 6, rel=0.02)
