"""CUDA twin of `melt.reference.flood_motion`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_motion import cut_move
from melt.physics.phases import AIRBORNE, LIQUID


@cuda_kernel
def _flood_kick(phase, acceleration, flood, dt, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] == LIQUID:
        velocity[0, i] += dt * acceleration[0, i]
        velocity[1, i] += dt * acceleration[1, i]
    elif phase[i] == AIRBORNE:
        velocity[2, i] -= dt * flood.gravity


def flood_kick(phase, acceleration, flood, dt, velocity):
    """See `melt.reference.flood_motion.flood_kick`."""
    _flood_kick.launch(phase.shape[0], phase, acceleration, flood, dt, velocity)


@cuda_kernel
def _flood_drift(phase, velocity, basin, dt, position, position_before):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    wide = position.dtype.type
    if phase[i] != LIQUID and phase[i] != AIRBORNE:
        return
    x, y, z = position[0, i], position[1, i], position[2, i]
    if position_before.shape[1] > 0:  # none without a control force
        position_before[0, i], position_before[1, i], position_before[2, i] = x, y, z
    dx, dy = cut_move(dt * velocity[0, i], dt * velocity[1, i], basin.longest_move)
    position[0, i], position[1, i] = x + wide(dx), y + wide(dy)
    if phase[i] == AIRBORNE:
        position[2, i] = z + wide(dt * velocity[2, i])


def flood_drift(phase, velocity, basin, dt, position, position_before):
    """See `melt.reference.flood_motion.flood_drift`."""
    _flood_drift.launch(phase.shape[0], phase, velocity, basin, dt, position, position_before)


@cuda_kernel
def _flood_land(bed, depth, position, phase, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = velocity.dtype.type
    wide = position.dtype.type
    if phase[i] == AIRBORNE and position[2, i] <= wide(bed[i] + depth[i]):
        phase[i], velocity[2, i] = LIQUID, real(0)


def flood_land(bed, depth, position, phase, velocity):
    """See `melt.reference.flood_motion.flood_land`."""
    _flood_land.launch(phase.shape[0], bed, depth, position, phase, velocity)


@cuda_kernel
def _damp_columns(phase, factor, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] == LIQUID:
        velocity[0, i] *= factor
        velocity[1, i] *= factor
        velocity[2, i] *= factor


def damp_columns(phase, factor, velocity):
    """See `melt.reference.flood_motion.damp_columns`."""
    _damp_columns.launch(phase.shape[0], phase, factor, velocity)
