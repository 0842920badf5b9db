"""CPU twin of `melt.reference.flood_control`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.flood_control import STILL, mean_brake
from melt.physics.phases import LIQUID


@cpu_stage
def control_brake(position, position_before, phase, support_radius, terrain, terrain_grid, control, flood, brake):
    """See `melt.reference.flood_control.control_brake`."""
    real = type(flood.gravity)
    still = real(STILL) * control.probe
    for n in prange(phase.shape[0]):
        i = np.uint64(n)
        x, y = position[0, i], position[1, i]
        dx, dy = real(x - position_before[0, i]), real(y - position_before[1, i])
        move = math.sqrt(dx * dx + dy * dy)
        if phase[i] != LIQUID or move <= still:
            brake[i] = real(0)
        else:
            brake[i] = mean_brake(x, y, dx, dy, move, support_radius[i], terrain, terrain_grid, control, flood)
