"""CPU twin of `melt.reference.motion`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.phases import INACTIVE, LIQUID, SOLID


@cpu_stage
def kick(phase, mass, force, dt, velocity):
    """See `melt.reference.motion.kick`."""
    for i in prange(phase.shape[0]):
        if phase[i] <= SOLID:
            per_mass = dt / mass[i]
            velocity[0, i] += per_mass * force[0, i]
            velocity[1, i] += per_mass * force[1, i]
            velocity[2, i] += per_mass * force[2, i]


@cpu_stage
def goal_kick(site_particle, goal, lattice, dt, velocity):
    """See `melt.reference.motion.goal_kick`."""
    rate = lattice.stiffness / dt
    for s in prange(site_particle.shape[0]):
        if site_particle[s] >= 0:
            i = np.uint64(site_particle[s])
            velocity[0, i] += rate * goal[0, s]
            velocity[1, i] += rate * goal[1, s]
            velocity[2, i] += rate * goal[2, s]


@cpu_stage
def goal_move(site_particle, goal, lattice, position):
    """See `melt.reference.motion.goal_move`."""
    wide = position.dtype.type
    for s in prange(site_particle.shape[0]):
        if site_particle[s] >= 0:
            i = np.uint64(site_particle[s])
            position[0, i] += wide(lattice.stiffness * goal[0, s])
            position[1, i] += wide(lattice.stiffness * goal[1, s])
            position[2, i] += wide(lattice.stiffness * goal[2, s])


@cpu_stage
def drift(phase, velocity, dt, position):
    """See `melt.reference.motion.drift`."""
    wide = position.dtype.type
    step = wide(dt)
    for i in prange(phase.shape[0]):
        if phase[i] <= SOLID:
            position[0, i] += step * wide(velocity[0, i])
            position[1, i] += step * wide(velocity[1, i])
            position[2, i] += step * wide(velocity[2, i])


@cpu_stage
def leave_domain(position, domain, phase):
    """See `melt.reference.motion.leave_domain`."""
    for i in prange(phase.shape[0]):
        x, y, z = position[0, i], position[1, i], position[2, i]
        # a NaN or infinity is a fault that the host must see, not a particle that left
        finite = math.isfinite(x) and math.isfinite(y) and math.isfinite(z)
        outside = (
            x < domain.lower_x or x > domain.upper_x
            or y < domain.lower_y or y > domain.upper_y
            or z < domain.lower_z or z > domain.upper_z
        )
        if phase[i] == LIQUID and domain.delete == 1 and finite and outside:
            phase[i] = INACTIVE


@cpu_stage
def motion_bounds(phase, mass, velocity, force, motion_bounds):
    """See `melt.reference.motion.motion_bounds`."""
    real = mass.dtype.type
    n, pieces = phase.shape[0], motion_bounds.shape[1]
    for p in prange(pieces):
        speed2 = acceleration2 = real(0)
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            if phase[i] <= SOLID:
                u, v, w = velocity[0, i], velocity[1, i], velocity[2, i]
                per_mass = real(1) / mass[i]
                a, b, c = per_mass * force[0, i], per_mass * force[1, i], per_mass * force[2, i]
                s2, a2 = u * u + v * v + w * w, a * a + b * b + c * c
                # a NaN would lose every comparison that follows; infinity wins them
                speed2 = max(speed2, s2 if s2 == s2 else real(np.inf))
                acceleration2 = max(acceleration2, a2 if a2 == a2 else real(np.inf))
        motion_bounds[0, p] = math.sqrt(speed2)
        motion_bounds[1, p] = math.sqrt(acceleration2)
