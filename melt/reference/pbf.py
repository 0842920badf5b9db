r"""Density solve of the position based fluid. Boiling paper eqs (1)-(6), spec 2.1.

With n_i = sum_j V_j W_ij (itself included), kernels divided by their lattice sums, w = 1/m (0 for
what only displaces):

.. math::
    C_i = n_i - 1, \quad g_i = \sum_j V_j \nabla W_{ij}, \quad
    \lambda_i = \frac{-\max(C_i, C_{min})}{w_i |g_i|^2 + \sum_j w_j V_j^2 |\nabla W_{ij}|^2 + \epsilon}

    \Delta p_i = \omega w_i \sum_j \big( \lambda_i V_j + \lambda_j V_i + s_{ij} \tfrac{V_i + V_j}{2} \big) \nabla W_{ij},
    \quad s_{ij} = -\frac{k_s}{D_0} \Big( \frac{W(r)}{W(\Delta q)} \Big)^4

Of a partner that does not move (wall), lambda_i counts only where it pushes: particles of a wall that pull are
a corrugated surface that liquid and single drops stick to (a dam-break front ran 2.6 instead of 3.7 column
widths in the same time, a drop hung in the air between two walls).
"""

import numpy as np

from melt.reference._pbf import listed, tables


def _active(active_index, active_count):
    return active_index[: int(active_count[0])]


def pbf_lambda(
    position, volume, mobility, support_radius, kernel_scale, neighbour_count, neighbour_index, active_index,
    active_count, pbf, constraint, multiplier,
):
    """Write the density constraint and its Lagrange multiplier of the listed particles.

    Reads: position (3, n) [m], volume (n,) [m^3] (0 for what displaces nothing), mobility (n,) [1/kg],
        support_radius (n,) [m] and kernel_scale (2, t) (effect precision only), active_index (n,) of which
        the first active_count[0] count; pairs of the neighbour lists.
    Writes: constraint (n,) [1], multiplier (n,) [kg m^2]; others keep theirs.
    """
    on = _active(active_index, active_count)
    V, w = volume.astype(np.float64), mobility.astype(np.float64)
    _, _, _, W, grad = tables(position, support_radius, kernel_scale, pbf)
    near = listed(neighbour_count, neighbour_index)
    W, grad = np.where(near, W, 0.0), np.where(near, grad, 0.0)
    C = (V[None, :] * W).sum(axis=1) - 1  # (1)
    per_pair = V[None, :] * grad
    g = per_pair.sum(axis=2)
    D = w * (g**2).sum(axis=0) + (w[None, :] * (per_pair**2).sum(axis=0)).sum(axis=1) + float(pbf.softening)
    lam = np.where(D > 0, -np.maximum(C, float(pbf.minimum_error)) / np.where(D > 0, D, 1), 0.0)  # (4), (5)
    constraint[on] = C[on]
    multiplier[on] = lam[on]


def pbf_correction(
    position, volume, mobility, support_radius, iterations, multiplier, kernel_scale, neighbour_count,
    neighbour_index, active_index, active_count, pbf, iteration, correction,
):
    """Write the relaxed position corrections of the listed particles.

    A pair acts in an iteration k only if one of the two has more than k iterations.

    Reads: as `pbf_lambda`, multiplier (n,) [kg m^2], iterations (n,) (effect precision only).
    Writes: correction (3, n) [m]; others keep theirs.
    """
    on = _active(active_index, active_count)
    V, w = volume.astype(np.float64), mobility.astype(np.float64)
    lam = multiplier.astype(np.float64)
    _, r, R, _, grad = tables(position, support_radius, kernel_scale, pbf)
    s = -float(pbf.push) * (np.where(r < R, 1 - (r / R) ** 2, 0.0) * float(pbf.push_scale)) ** 12
    own = np.where(w[None, :] > 0, lam[:, None], np.minimum(lam[:, None], 0.0))  # walls do not pull
    bracket = own * V[None, :] + lam[None, :] * V[:, None] + s * (V[:, None] + V[None, :]) / 2
    bracket = np.where(listed(neighbour_count, neighbour_index), bracket, 0.0)
    if pbf.same_iterations == 0:
        acting = np.maximum(iterations[:, None], iterations[None, :]) > iteration
        bracket = np.where(acting, bracket, 0.0)
    correction[:, on] = float(pbf.omega) * w[on] * (bracket * grad)[:, on, :].sum(axis=2)  # (6)
