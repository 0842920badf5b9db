"""CPU twin of `melt.reference.flood_guard`."""

from melt._compile import cpu_stage, prange
from melt.physics.flood_motion import guarded
from melt.physics.phases import AIRBORNE, INACTIVE, LIQUID


@cpu_stage
def flood_guard(rest_volume, terrain_wall, basin, terrain_grid, phase, position, velocity, left_volume):
    """See `melt.reference.flood_guard.flood_guard`."""
    n, pieces = phase.shape[0], left_volume.shape[1]
    for p in prange(pieces):
        edge = blocked = 0.0
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            if phase[i] != LIQUID and phase[i] != AIRBORNE:
                continue
            x, y, u, v, fate = guarded(
                position[0, i], position[1, i], velocity[0, i], velocity[1, i], terrain_wall, terrain_grid, basin
            )
            if fate == 0:
                position[0, i], position[1, i], velocity[0, i], velocity[1, i] = x, y, u, v
                continue
            phase[i] = INACTIVE
            if fate == 1:
                edge += rest_volume[i]
            else:
                blocked += rest_volume[i]
        left_volume[0, p], left_volume[1, p], left_volume[2, p], left_volume[3, p] = edge, blocked, 0.0, 0.0
