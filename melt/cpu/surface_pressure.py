"""CPU twin of `melt.reference.surface_pressure`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.period import wrap


@cpu_stage
def surface_normal(dfsph_factor, neighbour_count, neighbour_index, pair_gradient, smoothing, surface_normal):
    """See `melt.reference.surface_pressure.surface_normal`."""
    real = type(smoothing.support)
    n, capacity = dfsph_factor.shape[0], neighbour_index.shape[1]
    for share in prange(64):  # fixed shares: a vectorised division and that of a loop's rest may round apart
        for i in range(share * n // 64, (share + 1) * n // 64):
            x = y = z = real(0)
            if dfsph_factor[i] > real(0):
                for k in range(np.uint64(min(neighbour_count[i], capacity))):
                    x += pair_gradient[0, i, k]
                    y += pair_gradient[1, i, k]
                    z += pair_gradient[2, i, k]
            size = math.sqrt(x * x + y * y + z * z)
            c = real(1) / size if size * smoothing.support > real(0.1) else real(0)
            surface_normal[0, i], surface_normal[1, i], surface_normal[2, i] = c * x, c * y, c * z


@cpu_stage
def surface_pressure(
    position, surface_normal, neighbour_count, neighbour_index, pair_gradient, smoothing, period, sigma, surface_pressure,
):
    """See `melt.reference.surface_pressure.surface_pressure`."""
    real = type(smoothing.support)
    n, capacity = surface_pressure.shape[0], neighbour_index.shape[1]
    per_dimension = real(1) / real(smoothing.dimension)
    sharpest = real(2) * real(smoothing.dimension - 1) / smoothing.support
    for share in prange(64):
        for i in range(share * n // 64, (share + 1) * n // 64):
            a, b, c = surface_normal[0, i], surface_normal[1, i], surface_normal[2, i]
            turn = filled = real(0)
            if a * a + b * b + c * c > real(0):
                x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
                for k in range(np.uint64(min(neighbour_count[i], capacity))):
                    j = np.uint64(neighbour_index[i, k])
                    u, v, w = surface_normal[0, j], surface_normal[1, j], surface_normal[2, j]
                    valid = real(1) if u * u + v * v + w * w > real(0) else real(0)
                    gx, gy, gz = pair_gradient[0, i, k], pair_gradient[1, i, k], pair_gradient[2, i, k]
                    x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
                    y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
                    z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
                    turn += valid * ((a - u) * gx + (b - v) * gy + (c - w) * gz)
                    filled -= valid * (x * gx + y * gy + z * gz)
            filled *= per_dimension
            curvature = turn / filled if filled > real(0.1) else real(0)
            surface_pressure[i] = sigma * max(-sharpest, min(curvature, sharpest))
