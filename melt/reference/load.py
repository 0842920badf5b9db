r"""Force of the liquid on moving bodies: the reaction to what their particles do to it. Slime spec 2.11, 3.

.. math:: \vec F_b = \sum_i V_i \sum_{j \in b} (p_i + p_j) \vec g_{ij}, \qquad
          \vec F_b = \sum_i \sum_{j \in b} \vec w_{ij} (\vec w_{ij} \cdot (\vec v_i - \vec v_j))

over liquid i. The sum goes over the lists of the liquid, which are those that the solves use: nothing is counted apart.
"""

import numpy as np

from melt.reference._period import nearest
from melt.reference._shares import SHARES


def _sums(driver, neighbour_count, neighbour_index, force, body_load):
    """Write the sums over 64 shares of particles of ``force(i, near)`` (3, k) on their neighbours, for each body."""
    n = len(neighbour_count)
    body_load[:] = 0
    for share in range(SHARES):
        for i in range(share * n // SHARES, (share + 1) * n // SHARES):
            near = neighbour_index[i, : neighbour_count[i]]
            F = force(i, near)
            for body in range(body_load.shape[1]):
                body_load[:, body, share] += F[:, driver[near] == body].sum(axis=1)


def pressure_load(
    driver, position, velocity, velocity_kept, volume, mobility, solver_pressure, neighbour_count, neighbour_index, pair_gradient,
    poisson, fluid, period, mirror, dt, body_load,
):
    """Write 64 partial sums of V_i (p_i + p_j) g_ij over pairs of free liquid i and body j.

    ``mirror`` 1: p_j = p_i + rho_0 (g - a_j).(x_j - x_i), as `poisson_acceleration` has it in walls; 0: p_j = 0, as
    `pressure_acceleration` has it.

    Reads: driver (n,): the body or -1, position (3, n) [m], velocity, velocity_kept (3, n) [m/s], volume (n,) [m^3], mobility
        (n,) [1/kg] (0: given velocity), solver_pressure (n,) [Pa], the lists, pair_gradient (3, n, m) [1/m].
    Writes: body_load (3, bodies, 64) [N].
    """
    p, x = solver_pressure.astype(float), position.astype(float)
    moved = (velocity.astype(float) - velocity_kept) / float(dt)
    gravity = np.array([fluid.gravity_x, fluid.gravity_y, fluid.gravity_z], float)

    def force(i, near):
        if not mobility[i] > 0:
            return np.zeros((3, len(near)))
        most = 6 * max(p[i], 0.0) if poisson.full > 0 else np.inf
        d = nearest(x[:, near] - x[:, i, None], period)
        below = float(poisson.rest_density) * ((gravity[:, None] - moved[:, near]) * d).sum(axis=0)
        both = p[i] + float(mirror) * (p[i] + np.clip(below, -most, most))
        return float(volume[i]) * both * pair_gradient[:, i, : len(near)].astype(float)

    _sums(driver, neighbour_count, neighbour_index, force, body_load)


def shear_load(driver, velocity, neighbour_count, neighbour_index, pair_shear, body_load):
    """Write 64 partial sums of w_ij (w_ij.(v_i - v_j)) over pairs of free liquid i and body j.

    Reads: driver (n,): the body or -1, velocity (3, n) [m/s] that the viscous solve found, the lists, pair_shear (3, n, m)
        [(kg/s)^(1/2)], 0 where the velocity is given.
    Writes: body_load (3, bodies, 64) [N].
    """
    v = velocity.astype(float)

    def force(i, near):
        w = pair_shear[:, i, : len(near)].astype(float)
        return w * (w * (v[:, i, None] - v[:, near])).sum(axis=0)

    _sums(driver, neighbour_count, neighbour_index, force, body_load)
