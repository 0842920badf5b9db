"""CPU twin of `melt.reference.body_force`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.phases import LIQUID
from melt.physics.smoothing import W


@cpu_stage
def buoyancy(phase, mass, temperature, fluid, force):
    """See `melt.reference.body_force.buoyancy`."""
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            continue
        lift = -mass[i] * fluid.expansion * (temperature[i] - fluid.reference_temperature)
        force[0, i] += lift * fluid.gravity_x
        force[1, i] += lift * fluid.gravity_y
        force[2, i] += lift * fluid.gravity_z


@cpu_stage
def drag(phase, mass, velocity, fluid, force):
    """See `melt.reference.body_force.drag`."""
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            continue
        rate = fluid.drag * mass[i]
        force[0, i] -= rate * velocity[0, i]
        force[1, i] -= rate * velocity[1, i]
        force[2, i] -= rate * velocity[2, i]


@cpu_stage
def surface_tension(position, phase, mass, neighbour_count, neighbour_index, smoothing, fluid, force):
    """See `melt.reference.body_force.surface_tension`."""
    real = type(smoothing.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            continue
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        sx = sy = sz = wide(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
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
