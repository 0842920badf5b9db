r"""Forces between columns from differences of the water surface. Flood spec 2, E6 (wb), E7, E10.

.. math::
    a_i = -g \sum_j A_j (\eta_j - \eta_i) \nabla\bar W - \epsilon_i g d_i S_i + \text{E10} + \text{E7}, \quad
    S_i = \sum_j A_j \nabla\bar W + \sum_b V_b \nabla W(h_i), \quad A_j = V_j/d_j

The first term takes pressure and bed together: it is exactly 0 where the surface is level. It lacks the
pressure at a front, where S_i does not close: epsilon_i turns that on. Walls close the sum and carry the column's
own surface, so they add nothing to the first term.

|S| l > 0.15 alone, as in the spec (from a study in one dimension), also holds inside a lake of columns that do not
stand in order (0.2 with a jitter of 0.15 spacings, 0.4 with 0.3), and pushed them with up to 2 m/s^2. So a void must be
one: no column or wall within 45 degrees of the way into it.
"""

import numpy as np

from melt.reference._flood import sample
from melt.reference._flood_forces import dW_over_r, separated, stabilisation

OPEN = 0.15  # |S| l from which a column may stand beside a void
CONE = np.cos(np.pi / 4)  # and it does if nobody stands within 45 degrees of the way into it


def _at_void(S, h, between, reach):
    """Return which columns stand beside a void: S does not close, and no partner is where it points away from.

    Args:
        between: x_i - x_j (2, n, m) of columns and walls; grad W and S point at them.
        reach: (n, m), how near they must be.
    """
    size, r = np.sqrt((S**2).sum(axis=0)), np.sqrt((between**2).sum(axis=0))
    ahead = (between * S[:, :, None]).sum(axis=0)
    blocked = (r < reach) & (ahead > CONE * r * size[:, None])
    return (size * 0.5 * h > OPEN) & ~blocked.any(axis=1)


def _share(x, eta, d, h, S, void, most, terrain, terrain_grid, flood):
    """Return epsilon: how far the surface stands above the bed in the void, or how unlike the neighbours' it is."""
    size = np.sqrt((S**2).sum(axis=0))
    t = np.clip(most / (float(flood.front) * d), 0.0, 1.0)
    probe = x - 0.5 * h * S / np.where(size > 0, size, 1.0)
    b = sample(probe, terrain, terrain_grid, int(terrain_grid.sampler))[0]
    return np.where(void, np.clip((eta - b) / d, 0.0, 1.0), t * t * (3 - 2 * t))


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
    away = x[:, :, None] - x[:, None, :]
    reach = np.maximum(h[:, None], h[None, :])
    most = np.abs(np.where(np.sqrt((away**2).sum(axis=0)) < reach, rise, 0.0)).max(axis=1, initial=0.0)
    if wall_count.shape[0] > 0:
        x_ib = x[:, :, None] - boundary_position[:2].astype(np.float64)[:, None, :]
        F_b = dW_over_r(np.sqrt((x_ib**2).sum(axis=0)), h[:, None], flood)
        S += (boundary_area.astype(np.float64)[None, :] * F_b * x_ib).sum(axis=2)
        away = np.concatenate([away, x_ib], axis=2)
        reach = np.concatenate([reach, np.broadcast_to(h[:, None], x_ib.shape[1:])], axis=1)
    share = _share(x, eta, d, h, S, _at_void(S, h, away, reach), most, terrain, terrain_grid, flood)
    acceleration[:, wet] = a - share * g * d * S
