"""CPU twin of `melt.reference.flood_motion`."""

from melt._compile import cpu_stage, prange
from melt.physics.flood_motion import cut_move
from melt.physics.phases import AIRBORNE, LIQUID


@cpu_stage
def flood_kick(phase, acceleration, flood, dt, velocity):
    """See `melt.reference.flood_motion.flood_kick`."""
    for i in prange(phase.shape[0]):
        if phase[i] == LIQUID:
            velocity[0, i] += dt * acceleration[0, i]
            velocity[1, i] += dt * acceleration[1, i]
        elif phase[i] == AIRBORNE:
            velocity[2, i] -= dt * flood.gravity


@cpu_stage
def flood_drift(phase, velocity, basin, dt, position, position_before):
    """See `melt.reference.flood_motion.flood_drift`."""
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID and phase[i] != AIRBORNE:
            continue
        x, y, z = position[0, i], position[1, i], position[2, i]
        if position_before.shape[1] > 0:  # none without a control force
            position_before[0, i], position_before[1, i], position_before[2, i] = x, y, z
        dx, dy = cut_move(dt * velocity[0, i], dt * velocity[1, i], basin.longest_move)
        position[0, i], position[1, i] = x + wide(dx), y + wide(dy)
        if phase[i] == AIRBORNE:
            position[2, i] = z + wide(dt * velocity[2, i])


@cpu_stage
def flood_land(bed, depth, position, phase, velocity):
    """See `melt.reference.flood_motion.flood_land`."""
    real = velocity.dtype.type
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] == AIRBORNE and position[2, i] <= wide(bed[i] + depth[i]):
            phase[i], velocity[2, i] = LIQUID, real(0)


@cpu_stage
def damp_columns(phase, factor, velocity):
    """See `melt.reference.flood_motion.damp_columns`."""
    for i in prange(phase.shape[0]):
        if phase[i] == LIQUID:
            velocity[0, i] *= factor
            velocity[1, i] *= factor
            velocity[2, i] *= factor
