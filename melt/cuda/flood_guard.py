"""CUDA twin of `melt.reference.flood_guard`.

Columns are guarded a thread each; of the few that leave, the phase says why until the second launch, of a thread
for each of the 64 sums, has booked them.
"""

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_motion import guarded
from melt.physics.phases import AIRBORNE, INACTIVE, LIQUID

MARK = 16  # above all phases


@cuda_kernel
def _guard_columns(terrain_wall, basin, terrain_grid, phase, position, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] != LIQUID and phase[i] != AIRBORNE:
        return
    x, y, u, v, fate = guarded(
        position[0, i], position[1, i], velocity[0, i], velocity[1, i], terrain_wall, terrain_grid, basin
    )
    if fate == 0:
        position[0, i], position[1, i], velocity[0, i], velocity[1, i] = x, y, u, v
    else:
        phase[i] = MARK * fate


@cuda_kernel
def _guard_sums(rest_volume, phase, left_volume):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], left_volume.shape[1]
    if p >= pieces:
        return
    edge = blocked = 0.0
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        if phase[i] == MARK:
            edge += rest_volume[i]
            phase[i] = INACTIVE
        elif phase[i] == 2 * MARK:
            blocked += rest_volume[i]
            phase[i] = INACTIVE
    left_volume[0, p], left_volume[1, p], left_volume[2, p], left_volume[3, p] = edge, blocked, 0.0, 0.0


def flood_guard(rest_volume, terrain_wall, basin, terrain_grid, phase, position, velocity, left_volume):
    """See `melt.reference.flood_guard.flood_guard`."""
    _guard_columns.launch(phase.shape[0], terrain_wall, basin, terrain_grid, phase, position, velocity)
    _guard_sums.launch(left_volume.shape[1], rest_volume, phase, left_volume)
