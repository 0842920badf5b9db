"""CUDA twin of `melt.reference.density`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import INACTIVE, LIQUID
from melt.physics.smoothing import W


@cuda_kernel
def _density(
    position, phase, mass, volume, rest_volume, neighbour_count, neighbour_index,
    smoothing, fluid, density,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if phase[i] != LIQUID:
        density[i] = mass[i] / rest_volume[i] if phase[i] != INACTIVE else real(0)
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    total = wide(volume[i] * W(real(0), smoothing))
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        r = math.sqrt(x * x + y * y + z * z)
        total += volume[j] * W(r, smoothing)
    density[i] = fluid.density_factor * mass[i] / volume[i] * real(total)  # eq (1)


def density(
    position, phase, mass, volume, rest_volume, neighbour_count, neighbour_index,
    smoothing, fluid, density,
):
    """See `melt.reference.density.density`."""
    _density.launch(
        phase.shape[0], position, phase, mass, volume, rest_volume, neighbour_count,
        neighbour_index, smoothing, fluid, density,
    )
