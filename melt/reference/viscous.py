r"""Implicit viscosity: forces of pairs along their line, and the augmented Lagrangian. Slime spec 2.11.

    (M/dt + K + \gamma D^T V D) v = (M/dt) v^* + D^T V p,
    (K v)_i = \sum_j w_ij (w_ij \cdot (v_i - v_j)),    w_ij = \sqrt{k_ij} x_ij,
    k_ij = 2 (d+2) \bar\mu V_i V_j F/(r^2 + \epsilon),  F = -W'(r)/r,
    (D v)_i = -\sum_j g_ij \cdot (v_i - v_j),           (D^T V y)_i = -V_i \sum_j (y_i + y_j) g_ij.

A liquid that may be accelerated is free; the velocity of everything else is given. K and D^T V D are
symmetric, and rigid motion is in the null space of K.
"""

import numpy as np

from melt.reference._pairs import gradW
from melt.reference._period import nearest
from melt.reference._shares import rows, shares


def pair_shear(
    position, volume, mobility, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period, dt,
    pair_shear, viscous_block,
):
    r"""Write w_ij of each pair of a free particle, and the inverse of its diagonal block.

    \bar\mu = 2 mu_i mu_j/(mu_i + mu_j), or wall mu_i where mu_j = 0 (walls, moving bodies, solids). Block:
    m/dt + sum_j w w^T + V_i \gamma_i G G^T + sum_{j free} V_j \gamma_j (V_i/V_j)^2 g_ij g_ij^T, G = sum_j g_ij,
    \gamma_i = gamma mu_i, g_ij = V_j grad W_ij.

    Reads: position (3, n) [m], volume (n,) [m^3], mobility (n,) [1/kg], viscosity (n,) [Pa s], the lists.
    Writes: pair_shear (3, n, m) [(kg/s)^(1/2)], within the list's count; viscous_block (6, n) [s/kg].
        Both are 0 where the velocity is given (mobility or viscosity 0).
    """
    x, V, mu = position.astype(float), volume.astype(float), viscosity.astype(float)
    free = (mobility > 0) & (mu > 0)
    for i, near in rows(neighbour_count, neighbour_index):
        pair_shear[:, i, : len(near)] = 0
        viscous_block[:, i] = 0
        if not free[i]:
            continue
        x_ij = nearest(x[:, i, None] - x[:, near], period)
        r = np.sqrt((x_ij**2).sum(axis=0))
        grad = gradW(x_ij, r, smoothing)
        fluid = mu[near] > 0
        pair = np.where(fluid, 2 * mu[i] * mu[near] / (mu[i] + mu[near]), float(viscous.wall) * mu[i])
        F_r2 = -(grad * x_ij).sum(axis=0)
        F = np.where(F_r2 > 0, F_r2 / np.where(F_r2 > 0, r**2, 1.0), 0.0)
        k = float(viscous.strength) * pair * V[i] * V[near] * F / (r**2 + float(viscous.floor))
        w = np.sqrt(k) * x_ij
        gamma = float(viscous.gamma) * mu
        G = (V[near] * grad).sum(axis=1)
        other = np.where(free[near], gamma[near] * V[near] * V[i] ** 2, 0.0)
        block = np.eye(3) / (float(mobility[i]) * float(dt)) + w @ w.T
        block += V[i] * gamma[i] * np.outer(G, G) + (other * grad) @ grad.T
        inverse = np.linalg.inv(block)
        pair_shear[:, i, : len(near)] = w
        viscous_block[:, i] = [inverse[a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def dilation(
    velocity, viscosity, viscous_block, neighbour_count, neighbour_index, pair_gradient, viscous, dilation,
):
    """Write gamma mu_i (D v)_i of free particles, 0 elsewhere.

    Reads: velocity (3, n) [m/s] (or a search direction), viscosity (n,) [Pa s], viscous_block (6, n)
        (0: not free), the lists, pair_gradient (3, n, m) [1/m].
    Writes: dilation (n,) [Pa].
    """
    v = velocity.astype(float)
    for i, near in rows(neighbour_count, neighbour_index):
        Dv = -(pair_gradient[:, i, : len(near)].astype(float) * (v[:, i, None] - v[:, near])).sum()
        dilation[i] = float(viscous.gamma) * float(viscosity[i]) * Dv if viscous_block[0, i] > 0 else 0.0


def viscous_start(
    mass, volume, velocity, velocity_free, viscous_block, dilation, viscous_pressure, neighbour_count,
    neighbour_index, pair_gradient, pair_shear, dt, viscous_residual, viscous_direction, viscous_sums,
):
    r"""Write residual r, direction z = B r and the partial sums of r.z (row 0), r.r (3) and b.b (4).

    r = M/dt (v^* - v) - K v + D^T V (p - y), y = \gamma D v; b = M/dt v^*; all 0 where the velocity is given.

    Reads: mass (n,) [kg], volume (n,) [m^3], velocity (3, n) v (first guess), velocity_free (3, n) v^* [m/s],
        viscous_block (6, n) [s/kg] B, dilation (n,) [Pa] y of velocity and viscous_pressure (n,) [Pa] p, or
        both of length 0 (no such term), the lists, pair_gradient (3, n, m) [1/m], pair_shear (3, n, m).
    Writes: viscous_residual (3, n) [kg m/s^2], viscous_direction (3, n) [m/s], viscous_sums (5, 64).
    """
    v, v_free = velocity.astype(float), velocity_free.astype(float)
    y = viscous_pressure.astype(float) - dilation if len(dilation) else None
    b = np.zeros_like(v)
    for i, near in rows(neighbour_count, neighbour_index):
        viscous_residual[:, i] = viscous_direction[:, i] = 0
        if not viscous_block[0, i] > 0:
            continue
        inertia = float(mass[i]) / float(dt)
        r = inertia * (v_free[:, i] - v[:, i]) - _shear(i, near, pair_shear, v)
        r += _adjoint(i, near, pair_gradient, volume, y)
        b[:, i] = inertia * v_free[:, i]
        viscous_residual[:, i] = r
        viscous_direction[:, i] = _block(viscous_block[:, i]) @ r
    residual = viscous_residual.astype(float)
    for row, product in ((0, residual * viscous_direction), (3, residual**2), (4, b**2)):
        viscous_sums[row] = [s.sum() for s in shares(product.sum(axis=0))]


def _shear(i, near, w, v):
    """Return (K v)_i."""
    w = w[:, i, : len(near)].astype(float)
    return w @ (w * (v[:, i, None] - v[:, near])).sum(axis=0)


def _adjoint(i, near, g, volume, y):
    """Return (D^T V y)_i, 0 without y."""
    if y is None:
        return np.zeros(3)
    return -float(volume[i]) * g[:, i, : len(near)].astype(float) @ (y[i] + y[near])


def _block(six):
    xx, yy, zz, xy, xz, yz = six.astype(float)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
