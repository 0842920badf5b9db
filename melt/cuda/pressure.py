"""CUDA twin of `melt.reference.pressure`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.coupling import bounded
from melt.physics.eos import tait
from melt.physics.phases import LIQUID
from melt.physics.smoothing import W


@cuda_kernel
def _tait_pressure(phase, mass, volume, density, fluid, pressure):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] == LIQUID:
        pressure[i] = tait(density[i], mass[i] / volume[i], fluid)
    else:
        pressure[i] = 0


def tait_pressure(phase, mass, volume, density, fluid, pressure):
    """See `melt.reference.pressure.tait_pressure`."""
    _tait_pressure.launch(phase.shape[0], phase, mass, volume, density, fluid, pressure)


@cuda_kernel
def _boundary_pressure(
    position, phase, density, pressure, neighbour_count, neighbour_index, smoothing, fluid, boundary_pressure,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if phase[i] != LIQUID:
        boundary_pressure[i] = real(0)
        return
    beside = 0
    for k in range(neighbour_count[i]):
        beside += phase[neighbour_index[i, k]] != LIQUID
    if beside == 0:
        boundary_pressure[i] = pressure[i]
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    w_i = W(real(0), smoothing)
    total, p, head = wide(w_i), wide(w_i * pressure[i]), wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        if phase[j] != LIQUID:
            continue
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        w = W(math.sqrt(x * x + y * y + z * z), smoothing)
        total += w
        p += w * pressure[j]
        head += w * (fluid.gravity_x * x + fluid.gravity_y * y + fluid.gravity_z * z)
    mean = real(p / total)
    boundary_pressure[i] = mean + bounded(density[i] * real(head / total), mean)


def boundary_pressure(
    position, phase, density, pressure, neighbour_count, neighbour_index, smoothing, fluid, boundary_pressure,
):
    """See `melt.reference.pressure.boundary_pressure`."""
    _boundary_pressure.launch(
        phase.shape[0], position, phase, density, pressure, neighbour_count, neighbour_index, smoothing, fluid,
        boundary_pressure,
    )
