"""CPU twin of `melt.reference.viscous`. Sums: 64 shares of particles, added in order."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.cpu._viscous import adjoint_row, fill_shear, outer_dilation, outer_shear, shear_row
from melt.physics.viscous import block_times, inverse_block


@cpu_stage
def pair_shear(
    position, volume, mobility, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period, dt,
    pair_shear, viscous_block,
):
    """See `melt.reference.viscous.pair_shear`. The block is summed in float64: it may be nearly of rank one."""
    real = type(smoothing.support)
    wide = np.float64
    n = mobility.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: walls have no pairs
        for i in range(piece * n // 64, (piece + 1) * n // 64):
            mu_i = viscosity[i]
            if not ((mobility[i] > real(0)) & (mu_i > real(0))):
                for a in range(np.uint64(6)):
                    viscous_block[a, i] = real(0)
                for a in range(np.uint64(3)):
                    for k in range(np.uint64(neighbour_count[i])):
                        pair_shear[a, i, k] = real(0)
                continue
            fill_shear(i, position, volume, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period, pair_shear)
            xx, yy, zz, xy, xz, yz = outer_shear(i, neighbour_count, pair_shear)
            if viscous.gamma > real(0):
                a, b, c, d, e, f, gx, gy, gz = outer_dilation(
                    i, position, volume, mobility, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period
                )
                own = wide(volume[i] * viscous.gamma * mu_i)
                xx, yy, zz = xx + (a + own * gx * gx), yy + (b + own * gy * gy), zz + (c + own * gz * gz)
                xy, xz, yz = xy + (d + own * gx * gy), xz + (e + own * gx * gz), yz + (f + own * gy * gz)
            inertia = wide(1) / (wide(mobility[i]) * wide(dt))
            block = inverse_block(inertia + xx, inertia + yy, inertia + zz, xy, xz, yz)
            viscous_block[0, i], viscous_block[1, i], viscous_block[2, i] = real(block[0]), real(block[1]), real(block[2])
            viscous_block[3, i], viscous_block[4, i], viscous_block[5, i] = real(block[3]), real(block[4]), real(block[5])


@cpu_stage
def dilation(
    velocity, viscosity, viscous_block, neighbour_count, neighbour_index, pair_gradient, viscous, dilation,
):
    """See `melt.reference.viscous.dilation`."""
    real = type(viscous.gamma)
    n = viscosity.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: walls have no pairs
        for i in range(piece * n // 64, (piece + 1) * n // 64):
            if not viscous_block[0, i] > real(0):
                dilation[i] = real(0)
                continue
            u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
            total = real(0)
            for k in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, k])
                total += (
                    pair_gradient[0, i, k] * (velocity[0, j] - u_i)
                    + pair_gradient[1, i, k] * (velocity[1, j] - v_i)
                    + pair_gradient[2, i, k] * (velocity[2, j] - w_i)
                )
            dilation[i] = viscous.gamma * viscosity[i] * total


@cpu_stage
def viscous_start(
    mass, volume, velocity, velocity_free, viscous_block, dilation, viscous_pressure, neighbour_count,
    neighbour_index, pair_gradient, pair_shear, dt, viscous_residual, viscous_direction, viscous_sums,
):
    """See `melt.reference.viscous.viscous_start`."""
    real = type(dt)
    wide = np.float64
    n = mass.shape[0]
    augmented = dilation.shape[0] > 0
    for chunk in prange(64):
        share = (chunk * 37) % 64  # dealt out: walls have no pairs
        rz = rr = bb = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            if not viscous_block[0, i] > real(0):
                for a in range(np.uint64(3)):
                    viscous_residual[a, i] = real(0)
                    viscous_direction[a, i] = real(0)
                continue
            c = mass[i] / dt
            fx, fy, fz = shear_row(i, neighbour_count, neighbour_index, pair_shear, velocity)
            u, v, w = velocity_free[0, i], velocity_free[1, i], velocity_free[2, i]
            x = c * (u - velocity[0, i]) - fx
            y = c * (v - velocity[1, i]) - fy
            z = c * (w - velocity[2, i]) - fz
            if augmented:
                px, py, pz = adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, viscous_pressure)
                qx, qy, qz = adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, dilation)
                x, y, z = x + (px - qx), y + (py - qy), z + (pz - qz)
            dx, dy, dz = block_times(viscous_block, i, x, y, z)
            viscous_residual[0, i], viscous_residual[1, i], viscous_residual[2, i] = x, y, z
            viscous_direction[0, i], viscous_direction[1, i], viscous_direction[2, i] = dx, dy, dz
            rz += wide(x) * wide(dx) + wide(y) * wide(dy) + wide(z) * wide(dz)
            rr += wide(x) * wide(x) + wide(y) * wide(y) + wide(z) * wide(z)
            x, y, z = c * u, c * v, c * w
            bb += wide(x) * wide(x) + wide(y) * wide(y) + wide(z) * wide(z)
        viscous_sums[0, share], viscous_sums[3, share], viscous_sums[4, share] = rz, rr, bb
