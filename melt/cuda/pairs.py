"""CUDA twin of `melt.reference.pairs`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.period import wrap
from melt.physics.phases import INACTIVE, LIQUID, SOLID
from melt.physics.smoothing import W, dW


@cuda_kernel
def _mobility(phase, mass, held, mobility):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = mass.dtype.type
    free = (phase[i] == LIQUID and held[i] == 0) or phase[i] == SOLID
    mobility[i] = real(1) / mass[i] if free and mass[i] > real(0) else real(0)


def mobility(phase, mass, held, mobility):
    """See `melt.reference.pairs.mobility`."""
    _mobility.launch(phase.shape[0], phase, mass, held, mobility)


@cuda_kernel
def _pair_gradient(
    position, phase, volume, mobility, neighbour_count, neighbour_index, smoothing, period, dfsph,
    pair_gradient, density_ratio, dfsph_factor,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    least2 = real(1e-18) * smoothing.support * smoothing.support
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    total = gx = gy = gz = squares = real(0)
    for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
        j = neighbour_index[i, k]
        x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
        y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
        z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
        r2 = x * x + y * y + z * z
        r = math.sqrt(max(r2, least2))  # the floor keeps 1/r finite; what it gives is dropped
        c = volume[j] * (dW(r, smoothing) / r if r2 > least2 else real(0))
        a, b, d = c * x, c * y, c * z
        pair_gradient[0, i, k], pair_gradient[1, i, k], pair_gradient[2, i, k] = a, b, d
        total += volume[j] * W(r, smoothing)
        gx += a
        gy += b
        gz += d
        squares += mobility[j] * (a * a + b * b + d * d)
    density_ratio[i] = real(0) if phase[i] == INACTIVE else real(1)
    dfsph_factor[i] = real(0)
    if phase[i] != LIQUID:
        return
    density_ratio[i] = volume[i] * W(real(0), smoothing) + total
    own = mobility[i]
    if own > real(0):
        all_squares = gx * gx + gy * gy + gz * gz + squares / own
        if all_squares >= dfsph.least:
            dfsph_factor[i] = real(1) / (own * volume[i] * all_squares)


def pair_gradient(
    position, phase, volume, mobility, neighbour_count, neighbour_index, smoothing, period, dfsph,
    pair_gradient, density_ratio, dfsph_factor,
):
    """See `melt.reference.pairs.pair_gradient`."""
    _pair_gradient.launch(
        phase.shape[0], position, phase, volume, mobility, neighbour_count, neighbour_index, smoothing, period, dfsph,
        pair_gradient, density_ratio, dfsph_factor,
    )
