"""CUDA twin of `melt.reference.surface_pressure`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.period import wrap


@cuda_kernel
def _surface_normal(dfsph_factor, neighbour_count, neighbour_index, pair_gradient, smoothing, surface_normal):
    i = cuda.grid(1)
    if i >= dfsph_factor.shape[0]:
        return
    real = type(smoothing.support)
    x = y = z = real(0)
    if dfsph_factor[i] > real(0):
        for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
            x += pair_gradient[0, i, k]
            y += pair_gradient[1, i, k]
            z += pair_gradient[2, i, k]
    size = math.sqrt(x * x + y * y + z * z)
    c = real(1) / size if size * smoothing.support > real(0.1) else real(0)
    surface_normal[0, i], surface_normal[1, i], surface_normal[2, i] = c * x, c * y, c * z


def surface_normal(dfsph_factor, neighbour_count, neighbour_index, pair_gradient, smoothing, surface_normal):
    """See `melt.reference.surface_pressure.surface_normal`."""
    _surface_normal.launch(
        dfsph_factor.shape[0], dfsph_factor, neighbour_count, neighbour_index, pair_gradient, smoothing, surface_normal
    )


@cuda_kernel
def _surface_pressure(
    position, surface_normal, neighbour_count, neighbour_index, pair_gradient, smoothing, period, sigma, surface_pressure,
):
    i = cuda.grid(1)
    if i >= surface_pressure.shape[0]:
        return
    real = type(smoothing.support)
    a, b, c = surface_normal[0, i], surface_normal[1, i], surface_normal[2, i]
    turn = filled = real(0)
    if a * a + b * b + c * c > real(0):
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
            j = neighbour_index[i, k]
            u, v, w = surface_normal[0, j], surface_normal[1, j], surface_normal[2, j]
            if u * u + v * v + w * w > real(0):
                gx, gy, gz = pair_gradient[0, i, k], pair_gradient[1, i, k], pair_gradient[2, i, k]
                x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
                y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
                z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
                turn += (a - u) * gx + (b - v) * gy + (c - w) * gz
                filled -= x * gx + y * gy + z * gz
    filled *= real(1) / real(smoothing.dimension)
    curvature = turn / filled if filled > real(0.1) else real(0)
    sharpest = real(2) * real(smoothing.dimension - 1) / smoothing.support
    surface_pressure[i] = sigma * max(-sharpest, min(curvature, sharpest))


def surface_pressure(
    position, surface_normal, neighbour_count, neighbour_index, pair_gradient, smoothing, period, sigma, surface_pressure,
):
    """See `melt.reference.surface_pressure.surface_pressure`."""
    _surface_pressure.launch(
        surface_pressure.shape[0], position, surface_normal, neighbour_count, neighbour_index, pair_gradient, smoothing, period,
        sigma, surface_pressure,
    )
