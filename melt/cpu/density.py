"""CPU twin of `melt.reference.density`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.phases import INACTIVE, LIQUID
from melt.physics.smoothing import W


@cpu_stage
def density(
    position, phase, mass, volume, rest_volume, neighbour_count, neighbour_index,
    smoothing, fluid, density,
):
    """See `melt.reference.density.density`."""
    real = type(smoothing.support)
    wide = position.dtype.type  # sums are as wide as positions (precision `mixed`)
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            rest = mass[i] / rest_volume[i] if phase[i] != INACTIVE else real(0)
            density[i] = rest
            continue
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        total = wide(volume[i] * W(real(0), smoothing))
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            r = math.sqrt(x * x + y * y + z * z)
            total += volume[j] * W(r, smoothing)
        density[i] = fluid.density_factor * mass[i] / volume[i] * real(total)  # eq (1)
