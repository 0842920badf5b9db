"""CPU twin of `melt.reference.pressure`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.coupling import bounded
from melt.physics.eos import tait
from melt.physics.phases import LIQUID
from melt.physics.smoothing import W


@cpu_stage
def tait_pressure(phase, mass, volume, density, fluid, pressure):
    """See `melt.reference.pressure.tait_pressure`."""
    for i in prange(phase.shape[0]):
        if phase[i] == LIQUID:
            pressure[i] = tait(density[i], mass[i] / volume[i], fluid)
        else:
            pressure[i] = 0


@cpu_stage
def boundary_pressure(
    position, phase, density, pressure, neighbour_count, neighbour_index, smoothing, fluid, boundary_pressure,
):
    """See `melt.reference.pressure.boundary_pressure`."""
    real = type(smoothing.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            boundary_pressure[i] = real(0)
            continue
        # liquid away from boundaries, most of it, is told by one gather a pair
        beside = 0
        for k in range(np.uint64(neighbour_count[i])):
            beside += phase[np.uint64(neighbour_index[i, k])] != LIQUID
        if beside == 0:
            boundary_pressure[i] = pressure[i]
            continue
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        w_i = W(real(0), smoothing)
        total, p, head = wide(w_i), wide(w_i * pressure[i]), wide(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            w = W(math.sqrt(x * x + y * y + z * z), smoothing)
            w = w if phase[j] == LIQUID else real(0)
            total += w
            p += w * pressure[j]
            head += w * (fluid.gravity_x * x + fluid.gravity_y * y + fluid.gravity_z * z)
        mean = real(p / total)
        boundary_pressure[i] = mean + bounded(density[i] * real(head / total), mean)
