"""CPU twin of `melt.reference.pbf_motion`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.pbf import cut
from melt.physics.phases import SOLID


@cpu_stage
def pbf_predict(phase, fluid, pbf, vessel, dt, velocity, position, position_predicted):
    """See `melt.reference.pbf_motion.pbf_predict`."""
    real = type(pbf.support)
    wide = position.dtype.type
    most = real(0.5) * pbf.spacing / dt
    for i in prange(phase.shape[0]):
        x, y, z = position[0, i], position[1, i], position[2, i]
        position_predicted[0, i], position_predicted[1, i], position_predicted[2, i] = x, y, z
        if phase[i] > SOLID:
            continue
        u = velocity[0, i] + dt * fluid.gravity_x
        v = velocity[1, i] + dt * fluid.gravity_y
        w = velocity[2, i] + dt * fluid.gravity_z
        speed = math.sqrt(u * u + v * v + w * w)
        if speed > most:
            slow = most / speed
            u, v, w = slow * u, slow * v, slow * w
        velocity[0, i], velocity[1, i], velocity[2, i] = u, v, w
        x, y, z = x + wide(dt) * wide(u), y + wide(dt) * wide(v), z + wide(dt) * wide(w)
        position_predicted[0, i], position_predicted[1, i], position_predicted[2, i] = x, y, z
        position[0, i] = min(max(x, wide(vessel.lower_x)), wide(vessel.upper_x))
        position[1, i] = min(max(y, wide(vessel.lower_y)), wide(vessel.upper_y))
        position[2, i] = min(max(z, wide(vessel.lower_z)), wide(vessel.upper_z))


@cpu_stage
def pbf_move(correction, active_index, active_count, pbf, vessel, position):
    """See `melt.reference.pbf_motion.pbf_move`."""
    most = type(pbf.spacing)(0.5) * pbf.spacing
    wide = position.dtype.type
    for a in prange(active_count[0]):
        i = np.uint64(active_index[a])
        share = cut(correction[0, i], correction[1, i], correction[2, i], most)
        x = position[0, i] + wide(share * correction[0, i])
        y = position[1, i] + wide(share * correction[1, i])
        z = position[2, i] + wide(share * correction[2, i])
        position[0, i] = min(max(x, wide(vessel.lower_x)), wide(vessel.upper_x))
        position[1, i] = min(max(y, wide(vessel.lower_y)), wide(vessel.upper_y))
        position[2, i] = min(max(z, wide(vessel.lower_z)), wide(vessel.upper_z))


@cpu_stage
def pbf_velocity(position, position_predicted, phase, dt, velocity):
    """See `melt.reference.pbf_motion.pbf_velocity`."""
    real = type(dt)
    per_dt = real(1) / dt
    for i in prange(phase.shape[0]):
        if phase[i] <= SOLID:
            velocity[0, i] += per_dt * real(position[0, i] - position_predicted[0, i])
            velocity[1, i] += per_dt * real(position[1, i] - position_predicted[1, i])
            velocity[2, i] += per_dt * real(position[2, i] - position_predicted[2, i])


@cpu_stage
def pbf_bounds(phase, velocity, constraint, pbf_bounds):
    """See `melt.reference.pbf_motion.pbf_bounds`."""
    real = constraint.dtype.type
    n, pieces = phase.shape[0], pbf_bounds.shape[1]
    for p in prange(pieces):
        speed2 = error = real(0)
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            if phase[i] <= SOLID:
                u, v, w, C = velocity[0, i], velocity[1, i], velocity[2, i], constraint[i]
                s2 = u * u + v * v + w * w
                # a NaN would lose every comparison that follows; infinity wins them
                speed2 = max(speed2, s2 if s2 == s2 else real(np.inf))
                error = max(error, C if C == C else real(np.inf))
        pbf_bounds[0, p] = math.sqrt(speed2)
        pbf_bounds[1, p] = error
