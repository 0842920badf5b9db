"""CPU twin of `melt.reference.poisson`. Sums in float64: 64 shares of particles, added in order."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.period import wrap
from melt.physics.poisson import poisson_entry, present_volume, wall_rise


@cpu_stage
def poisson_pairs(
    position, volume, completed_ratio, ghost_laplacian, dfsph_factor, neighbour_count, neighbour_index,
    smoothing, poisson, period, pair_poisson, poisson_ghost, poisson_diagonal,
):
    """See `melt.reference.poisson.poisson_pairs`."""
    real = type(smoothing.support)
    ghosts = ghost_laplacian.shape[0] > 0
    n = volume.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: walls have no pairs
        for i in range(piece * n // 64, (piece + 1) * n // 64):
            count = np.uint64(neighbour_count[i])
            if not dfsph_factor[i] > real(0):
                for k in range(count):
                    pair_poisson[i, k] = real(0)
                poisson_ghost[i] = real(0)
                poisson_diagonal[i] = real(0)
                continue
            x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
            V_i = present_volume(volume[i], completed_ratio[i])
            total = around = real(0)
            for k in range(count):
                j = np.uint64(neighbour_index[i, k])
                x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
                y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
                z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
                V_j = present_volume(volume[j], completed_ratio[j])
                s = poisson_entry(V_i, V_j, x * x + y * y + z * z, smoothing, poisson)
                around += s
                s = s if dfsph_factor[j] > real(0) else real(0)
                pair_poisson[i, k] = s
                total += s
            given = ghost_laplacian[i] if ghosts else real(0)
            lack = max((real(0.5) if ghosts else real(1)) * poisson.full - around / (real(2) * V_i), real(0))
            ghost = real(4) * V_i * (given if given > real(0) else lack)
            poisson_ghost[i] = ghost
            poisson_diagonal[i] = total + ghost


@cpu_stage
def poisson_start(
    velocity, volume, completed_ratio, poisson_ghost, poisson_diagonal, neighbour_count, neighbour_index,
    pair_gradient, pair_poisson, poisson_pressure, surface_pressure, poisson, dt, shift, poisson_residual, poisson_direction, poisson_sums,
):
    """See `melt.reference.poisson.poisson_start`."""
    real = type(dt)
    wide = np.float64
    n = volume.shape[0]
    for chunk in prange(64):
        share = (chunk * 37) % 64  # dealt out: walls have no pairs
        rz = rr = bb = left = number = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            if not poisson_diagonal[i] > real(0):
                poisson_residual[i] = real(0)
                poisson_direction[i] = real(0)
                continue
            u_i, v_i, w_i, p_i = velocity[0, i], velocity[1, i], velocity[2, i], poisson_pressure[i]
            rate = total = real(0)
            for k in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, k])
                mirror = real(1) if poisson_diagonal[j] > real(0) else real(2)
                rate += mirror * (
                    pair_gradient[0, i, k] * (u_i - velocity[0, j])
                    + pair_gradient[1, i, k] * (v_i - velocity[1, j])
                    + pair_gradient[2, i, k] * (w_i - velocity[2, j])
                )
                total += pair_poisson[i, k] * (p_i - poisson_pressure[j])
            s = max(completed_ratio[i], real(0.5))
            lack = poisson.pull * min(real(0), s - real(1)) / dt
            b = present_volume(volume[i], s) * poisson.rest_density * ((rate / s + lack) / dt) - shift
            if surface_pressure.shape[0] > 0:
                b += poisson_ghost[i] * surface_pressure[i]
            r = b - (total + poisson_ghost[i] * p_i)
            d = r / poisson_diagonal[i]
            poisson_residual[i], poisson_direction[i] = r, d
            rz += wide(r) * wide(d)
            rr += wide(r) * wide(r)
            bb += wide(b) * wide(b)
            left += wide(r)
            number += wide(1)
        poisson_sums[0, share], poisson_sums[3, share], poisson_sums[4, share] = rz, rr, bb
        poisson_sums[1, share], poisson_sums[2, share] = left, number


@cpu_stage
def poisson_acceleration(
    position, velocity, velocity_kept, volume, mobility, poisson_diagonal, solver_pressure, surface_pressure, neighbour_count,
    neighbour_index, pair_gradient, poisson, fluid, period, dt, pressure_acceleration,
):
    """See `melt.reference.poisson.poisson_acceleration`."""
    real = volume.dtype.type
    per_dt = real(1) / dt
    n = volume.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: walls have no pairs
        for i in range(piece * n // 64, (piece + 1) * n // 64):
            x = y = z = real(0)
            x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
            if mobility[i] > real(0):
                p = solver_pressure[i]
                twice = real(2) * surface_pressure[i] if surface_pressure.shape[0] > 0 else real(0)
                for k in range(np.uint64(neighbour_count[i])):
                    j = np.uint64(neighbour_index[i, k])
                    # what water that moves with the wall would add between here and there
                    below = wall_rise(
                        real(wrap(position[0, j] - x_i, period.length_x, period.inverse_x)),
                        real(wrap(position[1, j] - y_i, period.length_y, period.inverse_y)),
                        real(wrap(position[2, j] - z_i, period.length_z, period.inverse_z)),
                        fluid.gravity_x - per_dt * (velocity[0, j] - velocity_kept[0, j]),
                        fluid.gravity_y - per_dt * (velocity[1, j] - velocity_kept[1, j]),
                        fluid.gravity_z - per_dt * (velocity[2, j] - velocity_kept[2, j]),
                        p, poisson,
                    )
                    both = p + (solver_pressure[j] if poisson_diagonal[j] > real(0) else p + below) - twice
                    x += both * pair_gradient[0, i, k]
                    y += both * pair_gradient[1, i, k]
                    z += both * pair_gradient[2, i, k]
            c = -mobility[i] * volume[i]
            pressure_acceleration[0, i] = c * x
            pressure_acceleration[1, i] = c * y
            pressure_acceleration[2, i] = c * z


@cpu_stage
def poisson_finish(density_ratio, completed_ratio, poisson_diagonal, poisson, poisson_pressure, solver_pressure):
    """See `melt.reference.poisson.poisson_finish`."""
    real = type(poisson.pull)
    n = poisson_diagonal.shape[0]
    for share in prange(64):  # fixed shares: a vectorised division and that of a loop's rest may round apart
        for i in range(share * n // 64, (share + 1) * n // 64):
            wet = poisson_diagonal[i] > real(0)
            p = poisson_pressure[i] if wet else real(0)
            cut = (poisson.clamp == 1) | (density_ratio[i] < poisson.full_share)
            p = max(p, real(0)) if cut else p
            s = max(completed_ratio[i], real(0.5)) if wet else real(1)
            poisson_pressure[i] = p
            solver_pressure[i] = p / (s * s)
