"""CUDA twin of `melt.reference.motion`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import INACTIVE, LIQUID, SOLID


@cuda_kernel
def _kick(phase, mass, force, dt, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] <= SOLID:
        per_mass = dt / mass[i]
        velocity[0, i] += per_mass * force[0, i]
        velocity[1, i] += per_mass * force[1, i]
        velocity[2, i] += per_mass * force[2, i]


def kick(phase, mass, force, dt, velocity):
    """See `melt.reference.motion.kick`."""
    _kick.launch(phase.shape[0], phase, mass, force, dt, velocity)


@cuda_kernel
def _goal_kick(site_particle, goal, lattice, dt, velocity):
    s = cuda.grid(1)
    if s >= site_particle.shape[0]:
        return
    rate = lattice.stiffness / dt
    if site_particle[s] >= 0:
        i = site_particle[s]
        velocity[0, i] += rate * goal[0, s]
        velocity[1, i] += rate * goal[1, s]
        velocity[2, i] += rate * goal[2, s]


def goal_kick(site_particle, goal, lattice, dt, velocity):
    """See `melt.reference.motion.goal_kick`."""
    _goal_kick.launch(site_particle.shape[0], site_particle, goal, lattice, dt, velocity)


@cuda_kernel
def _goal_move(site_particle, goal, lattice, position):
    s = cuda.grid(1)
    if s >= site_particle.shape[0]:
        return
    wide = position.dtype.type
    if site_particle[s] >= 0:
        i = site_particle[s]
        position[0, i] += wide(lattice.stiffness * goal[0, s])
        position[1, i] += wide(lattice.stiffness * goal[1, s])
        position[2, i] += wide(lattice.stiffness * goal[2, s])


def goal_move(site_particle, goal, lattice, position):
    """See `melt.reference.motion.goal_move`."""
    _goal_move.launch(site_particle.shape[0], site_particle, goal, lattice, position)


@cuda_kernel
def _drift(phase, velocity, dt, position):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    wide = position.dtype.type
    step = wide(dt)
    if phase[i] <= SOLID:
        position[0, i] += step * wide(velocity[0, i])
        position[1, i] += step * wide(velocity[1, i])
        position[2, i] += step * wide(velocity[2, i])


def drift(phase, velocity, dt, position):
    """See `melt.reference.motion.drift`."""
    _drift.launch(phase.shape[0], phase, velocity, dt, position)


@cuda_kernel
def _leave_domain(position, domain, phase):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
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


def leave_domain(position, domain, phase):
    """See `melt.reference.motion.leave_domain`."""
    _leave_domain.launch(phase.shape[0], position, domain, phase)


@cuda_kernel
def _motion_bounds(phase, mass, velocity, force, motion_bounds):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], motion_bounds.shape[1]
    if p >= pieces:
        return
    real = mass.dtype.type
    speed2 = acceleration2 = real(0)
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        if phase[i] <= SOLID:
            u, v, w = velocity[0, i], velocity[1, i], velocity[2, i]
            a, b, c = force[0, i] / mass[i], force[1, i] / mass[i], force[2, i] / mass[i]
            s2, a2 = u * u + v * v + w * w, a * a + b * b + c * c
            # a NaN would lose every comparison that follows; infinity wins them
            speed2 = max(speed2, s2 if s2 == s2 else real(math.inf))
            acceleration2 = max(acceleration2, a2 if a2 == a2 else real(math.inf))
    motion_bounds[0, p] = math.sqrt(speed2)
    motion_bounds[1, p] = math.sqrt(acceleration2)


def motion_bounds(phase, mass, velocity, force, motion_bounds):
    """See `melt.reference.motion.motion_bounds`."""
    _motion_bounds.launch(motion_bounds.shape[1], phase, mass, velocity, force, motion_bounds)
