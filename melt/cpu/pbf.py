"""CPU twin of `melt.reference.pbf`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.pbf import acts, correction_factor, pair_scales, poly6, spiky_over_r


@cpu_stage
def pbf_lambda(
    position, volume, mobility, support_radius, kernel_scale, neighbour_count, neighbour_index, active_index,
    active_count, pbf, constraint, multiplier,
):
    """See `melt.reference.pbf.pbf_lambda`."""
    real = type(pbf.support)
    wide = position.dtype.type
    for a in prange(active_count[0]):
        i = np.uint64(active_index[a])
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        inverse, value, gradient = pair_scales(i, i, support_radius, kernel_scale, pbf)
        n = wide(volume[i] * poly6(real(0), inverse, value))
        gx = gy = gz = squares = wide(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            r2 = x * x + y * y + z * z
            inverse, value, gradient = pair_scales(i, j, support_radius, kernel_scale, pbf)
            f = volume[j] * spiky_over_r(r2, inverse, gradient, pbf)
            n += volume[j] * poly6(r2, inverse, value)
            gx -= f * x
            gy -= f * y
            gz -= f * z
            squares += mobility[j] * (f * f * r2)
        C = real(n - wide(1))  # (1); the difference before it is rounded
        g2 = real(gx * gx + gy * gy + gz * gz)
        D = mobility[i] * g2 + real(squares) + pbf.softening
        constraint[i] = C
        multiplier[i] = -max(C, pbf.minimum_error) / D if D > real(0) else real(0)  # (4), (5)


@cpu_stage
def pbf_correction(
    position, volume, mobility, support_radius, iterations, multiplier, kernel_scale, neighbour_count,
    neighbour_index, active_index, active_count, pbf, iteration, correction,
):
    """See `melt.reference.pbf.pbf_correction`."""
    real = type(pbf.support)
    wide = position.dtype.type
    for a in prange(active_count[0]):
        i = np.uint64(active_index[a])
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        lambda_i, V_i = multiplier[i], volume[i]
        whole = True if pbf.same_iterations == 1 else iterations[i] > iteration
        dx = dy = dz = wide(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            r2 = x * x + y * y + z * z
            inverse, value, gradient = pair_scales(i, j, support_radius, kernel_scale, pbf)
            f = correction_factor(r2, inverse, gradient, V_i, lambda_i, volume[j], multiplier[j], mobility[j], pbf)
            f = f if acts(whole, j, iterations, iteration) else real(0)
            dx += f * x
            dy += f * y
            dz += f * z
        scale = pbf.omega * mobility[i]
        correction[0, i] = scale * real(dx)  # (6)
        correction[1, i] = scale * real(dy)
        correction[2, i] = scale * real(dz)
