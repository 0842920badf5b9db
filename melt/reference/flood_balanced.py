r"""Forces between columns from differences of the water surface. Flood spec 2, E6 (wb), E7, E10.

.. math::
    a_i = -g \sum_j A_j (\eta_j - \eta_i) \nabla\bar W - \epsilon_i g d_i S_i + \text{E10} + \text{E7}, \quad
    S_i = \sum_j A_j \nabla\bar W + \sum_b V_b \nabla W(h_i), \quad A_j = V_j/d_j

The first term takes pressure and bed together: it is exactly 0 where the surface is level. It lacks the
pressure at a front, where S_i does not close: epsilon_i turns that on. Walls close the sum and carry the column's
own surface, so they add nothing to the first term.
"""

import numpy as np

from melt.reference._flood import sample
from melt.reference._flood_forces import dW_over_r, separated, stabilisation

OPEN = 0.15  # |S| l above which the column stands beside a void


def _share(x, eta, d, h, S, most, terrain, terrain_grid, flood):
    """Return epsilon: how far the surface stands above the bed in the void, or how unlike the neighbours' it is."""
    ell, size = 0.5 * h, np.sqrt((S**2).sum(axis=0))
    t = np.clip(most / (float(flood.front) * d), 0.0, 1.0)
    probe = x - ell * S / np.where(size > 0, size, 1.0)  # grad W points at the partner
    b = sample(probe, terrain, terrain_grid, int(terrain_grid.sampler))[0]
    return np.where(size * ell > OPEN, np.clip((eta - b) / d, 0.0, 1.0), t * t * (3 - 2 * t))


def balanced_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, bed, neighbour_count, neighbour_index,
    wall_count, wall_index, boundary_position, boundary_area, terrain, flood, terrain_grid, acceleration,
):
    """Write the acceleration of liquid columns, walls included; 0 for others.

    Reads: id (n,), position (3, n) [m], velocity (3, n) [m/s], phase (n,), rest_volume (n,) [m^3], depth,
        support_radius, bed (n,) [m], boundary_position (3, b) [m], boundary_area (b,) [m^2], terrain (nodes,) [m];
        neighbour lists, from which alone the largest difference of surfaces is taken.
    Writes: acceleration (2, n) [m/s^2].
    """
    wet = phase == 0
    acceleration[:] = 0.0
    h, d, b, V = (a[wet].astype(np.float64) for a in (support_radius, depth, bed, rest_volume))
    x, v = position[:2, wet].astype(np.float64), velocity[:2, wet].astype(np.float64)
    x_ij, r = separated(id[wet], position[:, wet], h)
    v_ij = v[:, :, None] - v[:, None, :]
    F = 0.5 * (dW_over_r(r, h[:, None], flood) + dW_over_r(r, h[None, :], flood))
    g, eta, A = float(flood.gravity), b + d, V / d
    rise = eta[None, :] - eta[:, None]
    Pi, drag = stabilisation(x_ij, r, v_ij, h, d, F, flood)
    a = -((g * A[None, :] * rise + V[None, :] * Pi) * F * x_ij).sum(axis=2) - (drag * V[None, :] * v_ij).sum(axis=2)
    S = (A[None, :] * F * x_ij).sum(axis=2)
    if wall_count.shape[0] > 0:
        x_ib = x[:, :, None] - boundary_position[:2].astype(np.float64)[:, None, :]
        F_b = dW_over_r(np.sqrt((x_ib**2).sum(axis=0)), h[:, None], flood)
        S += (boundary_area.astype(np.float64)[None, :] * F_b * x_ib).sum(axis=2)
    near = r < np.maximum(h[:, None], h[None, :])
    most = np.abs(np.where(near, rise, 0.0)).max(axis=1, initial=0.0)
    share = _share(x, eta, d, h, S, most, terrain, terrain_grid, flood)
    acceleration[:, wet] = a - share * g * d * S
