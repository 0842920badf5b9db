"""CPU twin of `melt.reference.slime_motion`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.period import into_box, missed, wrap
from melt.physics.phases import DRIVEN, LIQUID, SOLID


@cpu_stage
def keep_motion(position, velocity, position_kept, velocity_kept):
    """See `melt.reference.slime_motion.keep_motion`."""
    for i in prange(position.shape[1]):
        for a in range(3):
            position_kept[a, i] = position[a, i]
            velocity_kept[a, i] = velocity[a, i]


@cpu_stage
def restore_motion(position_kept, velocity_kept, position, velocity):
    """See `melt.reference.slime_motion.restore_motion`."""
    for i in prange(position.shape[1]):
        for a in range(3):
            position[a, i] = position_kept[a, i]
            velocity[a, i] = velocity_kept[a, i]


@cpu_stage
def drive(phase, driver, position, driver_motion, velocity):
    """See `melt.reference.slime_motion.drive`."""
    real, wide = velocity.dtype.type, position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] == DRIVEN and driver[i] >= 0:
            b = np.uint64(driver[i])
            x = real(position[0, i] - wide(driver_motion[6, b]))
            y = real(position[1, i] - wide(driver_motion[7, b]))
            z = real(position[2, i] - wide(driver_motion[8, b]))
            p, q, r = driver_motion[3, b], driver_motion[4, b], driver_motion[5, b]
            u, v, w = q * z - r * y, r * x - p * z, p * y - q * x
            k = driver_motion[9, b]
            velocity[0, i] = driver_motion[0, b] + (u + k * (q * w - r * v))
            velocity[1, i] = driver_motion[1, b] + (v + k * (r * u - p * w))
            velocity[2, i] = driver_motion[2, b] + (w + k * (p * v - q * u))


@cpu_stage
def nozzle_hold(phase, position, nozzle_place, nozzle_speed, held, velocity):
    """See `melt.reference.slime_motion.nozzle_hold`."""
    real, wide = velocity.dtype.type, position.dtype.type
    for i in prange(phase.shape[0]):
        inside = 0
        if phase[i] == LIQUID:
            for k in range(nozzle_speed.shape[0]):
                x = real(position[0, i] - wide(nozzle_place[0, k]))
                y = real(position[1, i] - wide(nozzle_place[1, k]))
                z = real(position[2, i] - wide(nozzle_place[2, k]))
                a, b, c = nozzle_place[3, k], nozzle_place[4, k], nozzle_place[5, k]
                t = x * a + y * b + z * c
                x, y, z = x - t * a, y - t * b, z - t * c
                off2, radius = x * x + y * y + z * z, nozzle_place[7, k]
                if inside == 0 and t <= real(0) and t >= -nozzle_place[6, k] and off2 <= radius * radius:
                    inside = 1
                    speed = nozzle_speed[k]
                    velocity[0, i], velocity[1, i], velocity[2, i] = speed * a, speed * b, speed * c
        held[i] = inside


@cpu_stage
def weight(position, phase, mass, fluid, force):
    """See `melt.reference.slime_motion.weight`."""
    real = mass.dtype.type
    for i in prange(phase.shape[0]):
        m = mass[i] if phase[i] <= SOLID else real(0)
        force[0, i] = m * (fluid.gravity_x - fluid.central * real(position[0, i]))
        force[1, i] = m * (fluid.gravity_y - fluid.central * real(position[1, i]))
        force[2, i] = m * (fluid.gravity_z - fluid.central * real(position[2, i]))


@cpu_stage
def free_kick(phase, mobility, force, dt, velocity):
    """See `melt.reference.slime_motion.free_kick`."""
    for i in prange(phase.shape[0]):
        if phase[i] <= SOLID:
            per_mass = dt * mobility[i]
            velocity[0, i] += per_mass * force[0, i]
            velocity[1, i] += per_mass * force[1, i]
            velocity[2, i] += per_mass * force[2, i]


@cpu_stage
def advect(phase, position_kept, velocity, period, dt, position):
    """See `melt.reference.slime_motion.advect`."""
    wide = position.dtype.type
    step = wide(dt)
    for i in prange(phase.shape[0]):
        if phase[i] <= SOLID or phase[i] == DRIVEN:
            x = position_kept[0, i] + step * wide(velocity[0, i])
            y = position_kept[1, i] + step * wide(velocity[1, i])
            z = position_kept[2, i] + step * wide(velocity[2, i])
            position[0, i] = into_box(x, period.lower_x, period.length_x, period.inverse_x)
            position[1, i] = into_box(y, period.lower_y, period.length_y, period.inverse_y)
            position[2, i] = into_box(z, period.lower_z, period.length_z, period.inverse_z)


@cpu_stage
def slime_bounds(phase, velocity, apic_phase, apic_affine, position, position_kept, period, dt, slime_bounds):
    """See `melt.reference.slime_motion.slime_bounds`."""
    real, wide = velocity.dtype.type, position.dtype.type
    n, apics, pieces = phase.shape[0], apic_phase.shape[0], slime_bounds.shape[1]
    step = wide(dt)
    for p in prange(pieces):
        speed2 = rate2 = miss2 = real(0)
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            if phase[i] == LIQUID:
                u, v, w = velocity[0, i], velocity[1, i], velocity[2, i]
                x = missed(position_kept[0, i], step * wide(u), position[0, i], period.length_x, period.inverse_x)
                y = missed(position_kept[1, i], step * wide(v), position[1, i], period.length_y, period.inverse_y)
                z = missed(position_kept[2, i], step * wide(w), position[2, i], period.length_z, period.inverse_z)
                a, b, c = real(x), real(y), real(z)
                s2, m2 = u * u + v * v + w * w, a * a + b * b + c * c
                # a NaN would lose every comparison that follows; infinity wins them
                speed2 = max(speed2, s2 if s2 == s2 else real(math.inf))
                miss2 = max(miss2, m2 if m2 == m2 else real(math.inf))
        for i in range(p * apics // pieces, (p + 1) * apics // pieces):
            if apic_phase[i] == LIQUID:
                c2 = real(0)
                for k in range(9):
                    c2 += apic_affine[k, i] * apic_affine[k, i]
                rate2 = max(rate2, c2 if c2 == c2 else real(math.inf))
        slime_bounds[0, p] = math.sqrt(speed2)
        slime_bounds[1, p] = math.sqrt(rate2)
        slime_bounds[2, p] = math.sqrt(miss2)


@cpu_stage
def arrival_correction(phase, velocity, position, position_kept, period, dt, velocity_correction):
    """See `melt.reference.slime_motion.arrival_correction`."""
    real = velocity.dtype.type
    rate = real(1) / dt
    for i in prange(phase.shape[0]):
        moves = phase[i] <= SOLID or phase[i] == DRIVEN
        x = real(wrap(position[0, i] - position_kept[0, i], period.length_x, period.inverse_x))
        y = real(wrap(position[1, i] - position_kept[1, i], period.length_y, period.inverse_y))
        z = real(wrap(position[2, i] - position_kept[2, i], period.length_z, period.inverse_z))
        velocity_correction[0, i] = velocity[0, i] - rate * x if moves else real(0)
        velocity_correction[1, i] = velocity[1, i] - rate * y if moves else real(0)
        velocity_correction[2, i] = velocity[2, i] - rate * z if moves else real(0)
