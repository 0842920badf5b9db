"""CUDA twin of `melt.reference.body_force`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID
from melt.physics.smoothing import W


@cuda_kernel
def _buoyancy(phase, mass, temperature, fluid, force):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] != LIQUID:
        return
    lift = -mass[i] * fluid.expansion * (temperature[i] - fluid.reference_temperature)
    force[0, i] += lift * fluid.gravity_x
    force[1, i] += lift * fluid.gravity_y
    force[2, i] += lift * fluid.gravity_z


def buoyancy(phase, mass, temperature, fluid, force):
    """See `melt.reference.body_force.buoyancy`."""
    _buoyancy.launch(phase.shape[0], phase, mass, temperature, fluid, force)


@cuda_kernel
def _drag(phase, mass, velocity, fluid, force):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] != LIQUID:
        return
    rate = fluid.drag * mass[i]
    force[0, i] -= rate * velocity[0, i]
    force[1, i] -= rate * velocity[1, i]
    force[2, i] -= rate * velocity[2, i]


def drag(phase, mass, velocity, fluid, force):
    """See `melt.reference.body_force.drag`."""
    _drag.launch(phase.shape[0], phase, mass, velocity, fluid, force)


@cuda_kernel
def _surface_tension(position, phase, mass, neighbour_count, neighbour_index, smoothing, fluid, force):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if phase[i] != LIQUID:
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    sx = sy = sz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        c = mass[j] * W(math.sqrt(x * x + y * y + z * z), smoothing)
        c = c if phase[j] == LIQUID else real(0)
        sx += c * x
        sy += c * y
        sz += c * z
    strength = fluid.surface_tension * mass[i]
    force[0, i] -= strength * real(sx)
    force[1, i] -= strength * real(sy)
    force[2, i] -= strength * real(sz)


def surface_tension(position, phase, mass, neighbour_count, neighbour_index, smoothing, fluid, force):
    """See `melt.reference.body_force.surface_tension`."""
    _surface_tension.launch(
        phase.shape[0], position, phase, mass, neighbour_count, neighbour_index, smoothing, fluid, force,
    )
