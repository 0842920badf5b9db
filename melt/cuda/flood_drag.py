"""CUDA twin of `melt.reference.flood_drag`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_control import brake_factor, friction_rate
from melt.physics.phases import LIQUID
from melt.physics.terrain import nearest_value


@cuda_kernel
def _flood_drag(position, phase, depth, brake, terrain_friction, flood, terrain_grid, friction, dt, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(dt)
    u, v = velocity[0, i], velocity[1, i]
    speed = math.sqrt(u * u + v * v)
    if phase[i] != LIQUID or speed == real(0):
        return
    value = friction.value
    if friction.mapped == 1:
        value = nearest_value(terrain_friction, terrain_grid, position[0, i], position[1, i])
    factor = real(1) / (real(1) + dt * friction_rate(value, depth[i], friction, flood) * speed)  # E15
    if friction.control == 1:
        factor *= brake_factor(brake[i], dt, factor * speed)
    velocity[0, i] = factor * u
    velocity[1, i] = factor * v


def flood_drag(position, phase, depth, brake, terrain_friction, flood, terrain_grid, friction, dt, velocity):
    """See `melt.reference.flood_drag.flood_drag`."""
    _flood_drag.launch(
        phase.shape[0], position, phase, depth, brake, terrain_friction, flood, terrain_grid, friction, dt, velocity,
    )
