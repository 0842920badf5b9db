r"""Pressure iterations of DFSPH, in the form with two gathers. Slime spec 2.7, in the volume form.

The source is the density error that is to go, as a density ratio. A pressure p makes

.. math:: \vec a_i = -\frac{V_i}{m_i} \sum_j (p_i + p_j) \vec g_{ij}, \qquad
          r_i = \text{source}_i + \Delta t^2 \sum_j \vec g_{ij} \cdot (\vec a_i - \vec a_j)

and a Jacobi iteration, relaxed and clamped, is p_i <- max(0, p_i + omega r_i alpha_i / dt^2) with alpha_i =
1/D_i of `melt.reference.pairs`. p_j is 0 for boundaries, which is the adjoint of the divergence: a
pressure mirrored there would count them twice. The divergence solve is the same with its own source.
"""

import numpy as np

from melt.reference._shares import rows, shares

SKIPPED = -1e5  # a source below this says: no pressure here


def pressure_start(compression_source, dfsph_factor, density_impulse, dfsph, dt, solver_pressure):
    """Write the pressure to start with: a share of that of the last solve, where the source is positive, else 0.

    At most ``warm_limit`` times what a cold start would take in its first, unrelaxed iteration.
    Reads: compression_source (n,), dfsph_factor (n,) [kg/m], density_impulse (n,) = p dt^2 [Pa s^2], dt [s].
    Writes: solver_pressure (n,) [Pa].
    """
    source, factor, dt = compression_source.astype(np.float64), dfsph_factor.astype(np.float64), float(dt)
    warm = float(dfsph.warm) * density_impulse.astype(np.float64)
    start = np.minimum(warm, float(dfsph.warm_limit) * source * factor) / dt**2
    solver_pressure[:] = np.where((source > 0) & (factor > 0), start, 0.0)


def pressure_acceleration(
    volume, mobility, solver_pressure, neighbour_count, neighbour_index, pair_gradient, pressure_acceleration,
):
    """Write a_i = -mobility_i V_i sum_j (p_i + p_j) g_ij; 0 where the mobility is 0.

    Solids, which have p = 0, get by it exactly the reaction to what they do to the liquid.
    Reads: volume (n,) [m^3], mobility (n,) [1/kg], solver_pressure (n,) [Pa], the lists, pair_gradient (3, n, capacity)
        [1/m]. Writes: pressure_acceleration (3, n) [m/s^2].
    """
    p, V, w = (a.astype(np.float64) for a in (solver_pressure, volume, mobility))
    for i, near in rows(neighbour_count, neighbour_index):
        g = pair_gradient[:, i, : len(near)].astype(np.float64)
        pressure_acceleration[:, i] = -w[i] * V[i] * (g * (p[i] + p[near])).sum(axis=1) if w[i] > 0 else 0.0


def pressure_update(
    pressure_acceleration, compression_source, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt,
    solver_pressure, compression_left, pressure_error,
):
    """Write p <- max(0, p + omega r alpha/dt^2) with the error r that p itself leaves, and what there is of r > 0.

    Without factor, or with a source of -1e5 and less, there is no pressure and no error. A NaN stays in p and
    counts as an infinite error, so that the host notices it.
    Reads: pressure_acceleration (3, n) [m/s^2] of solver_pressure, compression_source (n,), dfsph_factor (n,) [kg/m],
        the lists, pair_gradient (3, n, capacity) [1/m], dt [s].
    Writes: solver_pressure (n,) [Pa]; compression_left (n,) = max(r, 0); pressure_error (3, 64): its sum, its maximum,
        and the particles counted.
    """
    a, dt = pressure_acceleration.astype(np.float64), float(dt)
    act = (dfsph_factor > 0) & ~(compression_source <= SKIPPED)
    for i, near in rows(neighbour_count, neighbour_index):
        p = left = 0.0
        if act[i]:
            g = pair_gradient[:, i, : len(near)].astype(np.float64)
            r = float(compression_source[i]) + dt**2 * (g * (a[:, i : i + 1] - a[:, near])).sum()
            p = float(solver_pressure[i]) + float(dfsph.omega) * r * float(dfsph_factor[i]) / dt**2
            p, left = 0.0 if p <= 0 else p, np.inf if np.isnan(r) else max(r, 0.0)
        solver_pressure[i], compression_left[i] = p, left
    left = compression_left.astype(np.float64)
    pressure_error[0] = [s.sum() for s in shares(left)]
    pressure_error[1] = [s.max(initial=0.0) for s in shares(left)]
    pressure_error[2] = [s.sum() for s in shares(act)]


def pressure_extrapolate(momentum, solver_pressure, pressure_last):
    """Write p <- max(0, p + momentum (p - p_last)) and keep p as p_last: Nesterov's step between two iterations.

    Not in the source. The Jacobi iteration is a projected gradient step on the pressure; with momentum k/(k + 3) it takes
    a third of the iterations (measured on a dam break of 40 layers), if omega times the largest eigenvalue of D^-1 A stays
    below 4/3: omega = 1/3 does, 1/2 does not.
    Reads: momentum, solver_pressure (n,) and pressure_last (n,) [Pa]. Writes: both.
    """
    p = solver_pressure.astype(np.float64)
    ahead = p + float(momentum) * (p - pressure_last) if momentum > 0 else p
    solver_pressure[:] = np.where(ahead <= 0, 0.0, ahead)
    pressure_last[:] = p


def pressure_kick(pressure_acceleration, dt, velocity):
    """Write v += dt a.

    Reads: pressure_acceleration (3, n) [m/s^2], dt [s]. Writes: velocity (3, n) [m/s].
    """
    velocity[:] = velocity + float(dt) * pressure_acceleration.astype(np.float64)


def pressure_keep(solver_pressure, dt, density_impulse):
    """Write p dt^2 for the next start: it means the same whatever the next dt is.

    Reads: solver_pressure (n,) [Pa], dt [s]. Writes: density_impulse (n,) [Pa s^2].
    """
    density_impulse[:] = solver_pressure.astype(np.float64) * float(dt) ** 2
