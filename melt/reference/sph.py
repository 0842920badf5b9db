r"""Weakly compressible SPH of Mueller, Charypar, Gross 2003: the baseline of the boiling paper's Table 1. Boiling spec 1.

.. math::
    \rho_i = \sum_j m_j W_1, \quad P_i = k \max(\rho_i/\rho_0 - 1, 0)

    a_i = -\frac{1}{\rho_i} \sum_j V_j \frac{P_i + P_j}{2} \nabla W_2 + \frac{\mu}{\rho_i} \sum_j V_j (v_j - v_i) \nabla^2 W_3

m_j = rho_0 V0_j for all that displaces (liquid, solids, walls, bubbles), V_j = m_j/rho_j of liquid and V0_j of the others,
which carry P_i (mirror). Bubbles have no viscous share: they slip. Kernels are raw, not divided by their lattice sums.
"""

import numpy as np

from melt.reference._pairs import separations
from melt.reference._pbf import listed


def _displaced(phase, rest_volume):
    return np.where(phase <= 3, rest_volume.astype(np.float64), 0.0)


def sph_density(position, phase, rest_volume, neighbour_count, neighbour_index, sph, density, pressure, constraint):
    """Write density, pressure and relative compression of liquid; others are at rest.

    Reads: position (3, n) [m], phase (n,), rest_volume (n,) [m^3]; pairs of the neighbour lists, and each with itself.
    Writes: density (n,) [kg/m^3], pressure (n,) [Pa], constraint (n,) = rho/rho_0 - 1; others: rho_0, 0, 0.
    """
    R, rho_0 = float(sph.support), float(sph.rest_density)
    _, r = separations(position)
    W1 = 315 / (64 * np.pi * R**9) * np.where(r < R, R**2 - r**2, 0.0) ** 3
    m = rho_0 * _displaced(phase, rest_volume)
    rho = np.where(listed(neighbour_count, neighbour_index), m[None, :] * W1, 0.0).sum(axis=1)
    C = rho / rho_0 - 1
    liquid = phase == 0
    density[:] = np.where(liquid, rho, rho_0)
    constraint[:] = np.where(liquid, C, 0.0)
    pressure[:] = np.where(liquid, float(sph.stiffness) * np.maximum(C, 0.0), 0.0)


def sph_force(
    position, velocity, phase, rest_volume, density, pressure, neighbour_count, neighbour_index, sph, dt, velocity_next,
):
    """Write the velocity of liquid after a step under pressure and viscosity (gravity is not among them).

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), rest_volume (n,) [m^3], density (n,) [kg/m^3],
        pressure (n,) [Pa]; pairs of the neighbour lists.
    Writes: velocity_next (3, n) [m/s]; others keep theirs.
    """
    R, rho_0 = float(sph.support), float(sph.rest_density)
    x_ij, r = separations(position)
    v, rho, P = (a.astype(np.float64) for a in (velocity, density, pressure))
    liquid, boundary = phase == 0, (phase == 1) | (phase == 2)
    V = np.where(liquid, rho_0 / np.where(rho > 0, rho, 1.0), 1.0) * _displaced(phase, rest_volume)
    near = listed(neighbour_count, neighbour_index) & (r < R)
    apart = near & (r > 1e-9 * R)
    gradW2 = np.where(apart, -45 / (np.pi * R**6) * (R - r) ** 2 / np.where(apart, r, 1.0), 0.0) * x_ij
    lapW3 = np.where(near, 45 / (np.pi * R**6) * (R - r), 0.0)
    P_j = np.where(liquid[None, :], P[None, :], P[:, None])
    pushed = -(V[None, :] * (P[:, None] + P_j) / 2 * gradW2).sum(axis=2)
    U = np.where(liquid | boundary, V, 0.0)
    dragged = float(sph.viscosity) * (U[None, :] * lapW3 * (v[:, None, :] - v[:, :, None])).sum(axis=2)
    a = (pushed + dragged) / np.where(liquid, rho, 1.0)
    velocity_next[:] = np.where(liquid, v + float(dt) * a, v)
