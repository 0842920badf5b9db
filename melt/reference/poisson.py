r"""ISPH pressure Poisson equation: its matrix, right-hand side and result. Slime spec 2.9.

    (S p)_i = \sum_j s_ij (p_i - p_j) + 4 V_i \lambda_i p_i,  s_ij = 2 V_i V_j F r^2/(r^2 + \epsilon^2),
    S p = V [\dot s/(s dt) + \beta min(0, s - 1)/dt^2] \rho_0,  F = -W'(r)/r,

over particles with a pressure; s is the density ratio completed by ghosts, V = volume/max(s, 1/2), and
\lambda the ghosts' sum, whose pressure mirrors p in p = 0 half-way. Walls mirror velocity and carry what water at rest would.
"""

import numpy as np

from melt.reference._pairs import gradW
from melt.reference._period import nearest
from melt.reference._shares import rows, shares


def _volume(volume, completed_ratio):
    return volume.astype(float) / np.maximum(completed_ratio.astype(float), 0.5)


def poisson_pairs(
    position, volume, completed_ratio, ghost_laplacian, dfsph_factor, neighbour_count, neighbour_index,
    smoothing, poisson, period, pair_poisson, poisson_ghost, poisson_diagonal,
):
    """Write the entries s_ij, 0 unless both particles have a pressure, the ghosts' share and the diagonal.

    Where there is no ghost, what the neighbours' sum of V F lacks to ``poisson.full`` counts as air at the mirrored pressure;
    in a scene with ghosts what it lacks to half of that: fragments outside of the domain, where none are seeded.

    Reads: position (3, n) [m], volume (n,) [m^3], completed_ratio (n,), ghost_laplacian (n,) [1/m^2] or of
        length 0 (no ghosts), dfsph_factor (n,) (0: no pressure), the lists.
    Writes: pair_poisson (n, m) [m] within the list's count, poisson_ghost (n,) [m] = 4 V lambda,
        poisson_diagonal (n,) [m] = sum_j s_ij + poisson_ghost; 0 without pressure.
    """
    x, V = position.astype(float), _volume(volume, completed_ratio)
    act = dfsph_factor > 0
    for i, near in rows(neighbour_count, neighbour_index):
        x_ij = nearest(x[:, i, None] - x[:, near], period)
        r2 = (x_ij**2).sum(axis=0)
        F_r2 = -(gradW(x_ij, np.sqrt(r2), smoothing) * x_ij).sum(axis=0)
        s = 2 * V[i] * V[near] * F_r2 / (r2 + float(poisson.floor))
        share = 0.5 if len(ghost_laplacian) else 1.0
        lack = max(share * float(poisson.full) - s.sum() / (2 * V[i]), 0.0) if act[i] else 0.0
        s = np.where(act[i] & act[near], s, 0.0)
        given = float(ghost_laplacian[i]) if len(ghost_laplacian) else 0.0
        ghost = 4 * V[i] * (given if given > 0 else lack) if act[i] else 0.0
        pair_poisson[i, : len(near)] = s
        poisson_ghost[i] = ghost
        poisson_diagonal[i] = s.sum() + ghost


def poisson_start(
    velocity, volume, completed_ratio, poisson_ghost, poisson_diagonal, neighbour_count, neighbour_index,
    pair_gradient, pair_poisson, poisson_pressure, surface_pressure, poisson, dt, shift, poisson_residual, poisson_direction, poisson_sums,
):
    r"""Write residual r = b - S p, direction z = r/diagonal, and the partial sums of r.z, r, particles, r.r and b.b.

    s is taken as at least 1/2 throughout, for nodes at the rim that hold next to nothing.
    b_i = V_i \rho_0 [\dot s_i/(s_i dt) + pull min(0, s_i - 1)/dt^2], \dot s_i = sum_j c_j g_ij.(v_i - v_j) over all
    neighbours, minus ``shift``, which makes the sum of b vanish where no surface fixes the pressure; c_j = 2 for walls and
    all else without a pressure: their velocity is mirrored, 2 v_b - v_i, so that all of the flow into the wall counts.
    (With c_j = 1 half of it lies inside of the wall, and water at rest has half of its pressure, measured.)

    Reads: velocity (3, n) [m/s], volume (n,) [m^3], completed_ratio (n,), poisson_ghost, poisson_diagonal (n,)
        [m] (0: no pressure), the lists, pair_gradient (3, n, m) [1/m], pair_poisson (n, m) [m],
        poisson_pressure (n,) [Pa] p, the first guess, which has to be 0 where there is no pressure.
    Writes: poisson_residual (n,) [N/m], poisson_direction (n,) [Pa], poisson_sums (5, 64).
    """
    v, p, V = velocity.astype(float), poisson_pressure.astype(float), _volume(volume, completed_ratio)
    dt, b = float(dt), np.zeros(len(p))
    for i, near in rows(neighbour_count, neighbour_index):
        poisson_residual[i] = poisson_direction[i] = 0
        if not poisson_diagonal[i] > 0:
            continue
        s = max(float(completed_ratio[i]), 0.5)
        mirror = np.where(poisson_diagonal[near] > 0, 1.0, 2.0)
        rate = (mirror * pair_gradient[:, i, : len(near)].astype(float) * (v[:, i, None] - v[:, near])).sum()
        b[i] = V[i] * float(poisson.rest_density) * (rate / s / dt + float(poisson.pull) * min(0.0, s - 1) / dt**2)
        b[i] -= float(shift)
        b[i] += float(poisson_ghost[i]) * float(surface_pressure[i]) if len(surface_pressure) else 0.0
        r = b[i] - _times(i, near, pair_poisson, poisson_ghost, p)
        poisson_residual[i], poisson_direction[i] = r, r / float(poisson_diagonal[i])
    r = poisson_residual.astype(float)
    for row, product in ((0, r * poisson_direction), (1, r), (2, poisson_diagonal > 0), (3, r * r), (4, b * b)):
        poisson_sums[row] = [share.sum() for share in shares(product)]


def _times(i, near, pair_poisson, poisson_ghost, p):
    """Return (S p)_i."""
    return (pair_poisson[i, : len(near)].astype(float) * (p[i] - p[near])).sum() + float(poisson_ghost[i]) * p[i]


def poisson_acceleration(
    position, velocity, velocity_kept, volume, mobility, poisson_diagonal, solver_pressure, surface_pressure, neighbour_count,
    neighbour_index, pair_gradient, poisson, fluid, period, dt, pressure_acceleration,
):
    """Write a_i = -mobility_i V_i sum_j (p_i + p_j) g_ij; of walls, all without pressure, p_j = p_i + rho_0 (g - a_j).(x_j - x_i).

    The pressure in a wall is what water that moves with it, a_j = (velocity - velocity_kept)/dt, would have there (Adami et
    al. 2012), off p_i by 6 p_i at most, unless ``poisson.full`` is 0: with p_j = p_i alone the lowest layer keeps half of
    its weight. Tangential velocities take no part, or walls would brake.
    With surface tension the ghosts' share, -2 p_s sum_g V_g grad W, is 2 p_s sum_j g_ij, as all gradients together sum
    to zero.
    Reads: position (3, n) [m], velocity, velocity_kept (3, n) [m/s], volume (n,) [m^3], mobility (n,) [1/kg], poisson_diagonal (n,)
        [m] (0: no pressure), solver_pressure (n,) [Pa], the lists, pair_gradient (3, n, m) [1/m].
    Writes: pressure_acceleration (3, n) [m/s^2].
    """
    p, V, w = (a.astype(float) for a in (solver_pressure, volume, mobility))
    moved = (velocity.astype(float) - velocity_kept) / float(dt)
    gravity = np.array([fluid.gravity_x, fluid.gravity_y, fluid.gravity_z], float)
    for i, near in rows(neighbour_count, neighbour_index):
        d = nearest(position[:, near].astype(float) - position[:, i, None].astype(float), period)
        below = float(poisson.rest_density) * ((gravity[:, None] - moved[:, near]) * d).sum(axis=0)
        most = 6 * max(p[i], 0.0) if poisson.full > 0 else np.inf
        other = np.where(poisson_diagonal[near] > 0, p[near], p[i] + np.clip(below, -most, most))
        g = pair_gradient[:, i, : len(near)].astype(float)
        p_s = float(surface_pressure[i]) if len(surface_pressure) else 0.0
        pressure_acceleration[:, i] = -w[i] * V[i] * (g * (p[i] + other - 2 * p_s)).sum(axis=1) if w[i] > 0 else 0.0


def poisson_finish(density_ratio, completed_ratio, poisson_diagonal, poisson, poisson_pressure, solver_pressure):
    """Write the pressure, cut to >= 0 everywhere (clamp) or where density_ratio < full_share, and p/s^2.

    Reads: density_ratio, completed_ratio s (n,), poisson_diagonal (n,) [m] (0: no pressure).
    Writes: poisson_pressure (n,) [Pa] (0 without pressure), solver_pressure (n,) [Pa] = p/s^2.
    """
    p = np.where(poisson_diagonal > 0, poisson_pressure.astype(float), 0.0)
    cut = (density_ratio < poisson.full_share) | (poisson.clamp == 1)
    p = np.where(cut, np.maximum(p, 0), p)
    s = np.where(poisson_diagonal > 0, np.maximum(completed_ratio.astype(float), 0.5), 1.0)
    poisson_pressure[:] = p
    solver_pressure[:] = p / s**2
