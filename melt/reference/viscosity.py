"""Viscous exchange beside the artificial viscosity: laminar forces and XSPH. Melting spec 2.3, (3')."""

import numpy as np

from melt.reference._pairs import L, W, separations


def laminar_force(
    position, velocity, phase, mass, volume, density, neighbour_count, neighbour_index,
    smoothing, fluid, force,
):
    r"""Add the laminar viscous force to liquid, and its reaction to solids.

    .. math::
        F_{i \leftarrow j} = \mu \frac{m_i}{\rho_i} U_{ij} (v_j - v_i) L_{ij}, \quad
        U_{ij} = m_j/\rho_j \text{ (liquid j)}, \; \rho^0_i V_j/\rho_i \text{ (solid or wall j)}

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), mass (n,) [kg], volume (n,)
        [m^3], density (n,) [kg/m^3]; all pairs. Writes: adds to force (3, n) [N].
    """
    _, r = separations(position)
    v = np.asarray(velocity, dtype=np.float64)
    liquid, boundary = phase == 0, (phase == 1) | (phase == 2)
    m, V, rho = (np.asarray(a, dtype=np.float64) for a in (mass, volume, density))
    rho = np.where(rho > 0, rho, 1.0)
    rho0 = np.where(liquid, m / np.where(V > 0, V, 1.0), 0.0)
    U = np.where(liquid[None, :], (m / rho)[None, :], (rho0 / rho)[:, None] * V[None, :])
    acts = liquid[:, None] & (liquid | boundary)[None, :]
    c = np.where(acts, float(fluid.mu) * (m / rho)[:, None] * U * L(r, smoothing), 0.0)
    F = c * (v[:, None, :] - v[:, :, None])
    force[:, liquid] += F.sum(axis=2)[:, liquid]
    force[:, phase == 1] -= F.sum(axis=1)[:, phase == 1]


def xsph(
    position, velocity, phase, mass, density, neighbour_count, neighbour_index,
    smoothing, fluid, velocity_next,
):
    r"""Write velocities of liquid blended with their surroundings; others keep theirs.

    .. math:: v'_i = v_i + \varepsilon \sum_j \frac{2 m_j}{\rho_i + \rho_j} (v_j - v_i) W_{ij}

    over liquid j: conserves momentum. Reads: position (3, n) [m], velocity (3, n) [m/s],
        phase (n,), mass (n,) [kg], density (n,) [kg/m^3]. Writes: velocity_next (3, n) [m/s].
    """
    _, r = separations(position)
    v = np.asarray(velocity, dtype=np.float64)
    m, rho = np.asarray(mass, dtype=np.float64), np.asarray(density, dtype=np.float64)
    liquid = phase == 0
    both = liquid[:, None] & liquid[None, :]
    mean = np.where(both, rho[:, None] + rho[None, :], 2.0) / 2
    c = np.where(both, m[None, :] / mean * W(r, smoothing), 0.0)
    blended = v + float(fluid.xsph) * (c * (v[:, None, :] - v[:, :, None])).sum(axis=2)
    velocity_next[:] = np.where(liquid, blended, v)
