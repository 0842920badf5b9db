"""CUDA twin of `melt.reference.flood_control`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_control import STILL, mean_brake
from melt.physics.phases import LIQUID


@cuda_kernel
def _control_brake(position, position_before, phase, support_radius, terrain, terrain_grid, control, flood, brake):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(flood.gravity)
    still = real(STILL) * control.probe
    x, y = position[0, i], position[1, i]
    dx, dy = real(x - position_before[0, i]), real(y - position_before[1, i])
    move = math.sqrt(dx * dx + dy * dy)
    if phase[i] != LIQUID or move <= still:
        brake[i] = real(0)
    else:
        brake[i] = mean_brake(x, y, dx, dy, move, support_radius[i], terrain, terrain_grid, control, flood)


def control_brake(position, position_before, phase, support_radius, terrain, terrain_grid, control, flood, brake):
    """See `melt.reference.flood_control.control_brake`."""
    _control_brake.launch(
        phase.shape[0], position, position_before, phase, support_radius, terrain, terrain_grid, control, flood, brake,
    )
