"""CPU twin of `melt.reference.flood_drag`."""

import math

from melt._compile import cpu_stage, prange
from melt.physics.flood_control import brake_factor, friction_rate
from melt.physics.phases import LIQUID
from melt.physics.terrain import nearest_value


@cpu_stage
def flood_drag(position, phase, depth, brake, terrain_friction, flood, terrain_grid, friction, dt, velocity):
    """See `melt.reference.flood_drag.flood_drag`."""
    real = type(dt)
    for i in prange(phase.shape[0]):
        u, v = velocity[0, i], velocity[1, i]
        speed = math.sqrt(u * u + v * v)
        if phase[i] != LIQUID or speed == real(0):
            continue
        value = friction.value
        if friction.mapped == 1:
            value = nearest_value(terrain_friction, terrain_grid, position[0, i], position[1, i])
        factor = real(1) / (real(1) + dt * friction_rate(value, depth[i], friction, flood) * speed)  # E15
        if friction.control == 1:
            factor *= brake_factor(brake[i], dt, factor * speed)
        velocity[0, i] = factor * u
        velocity[1, i] = factor * v
