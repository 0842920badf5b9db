"""CPU twin of `melt.reference.vapour`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.phases import INACTIVE, VAPOUR
from melt.physics.philox import ball_offset
from melt.physics.vapour import poly6_pair, spiky_pair_over_r, vapour_radius


@cpu_stage
def vapour_source(
    burst_index, burst_top, free_index, vapour, boiling, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, age, vapour_support,
):
    """See `melt.reference.vapour.vapour_source`."""
    real = type(vapour.support)
    wide = position.dtype.type
    for a in prange(served):
        b, i = burst_index[a // vapour.per_burst], free_index[a]
        name = np.int32(first_id + a)
        x, y, z = ball_offset(name, step_low, step_high, boiling.seed_low, boiling.seed_high, 3, vapour.spread)
        position[0, i] = position[0, b] + wide(vapour.spread * x)
        position[1, i] = position[1, b] + wide(vapour.spread * y)
        position[2, i] = wide(burst_top[b]) + wide(vapour.spread * abs(z))  # not below the surface
        velocity[0, i] = velocity[1, i] = velocity[2, i] = real(0)
        phase[i], id[i] = VAPOUR, name
        mass[i], rest_volume[i], temperature[i] = vapour.mass, real(0), boiling.boiling_point
        age[i], vapour_support[i] = real(0), vapour.support


@cpu_stage
def vapour_density(
    position, phase, vapour_support, neighbour_count, neighbour_index, vapour, vapour_density, vapour_pressure,
):
    """See `melt.reference.vapour.vapour_density`."""
    real = type(vapour.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != VAPOUR:
            continue
        x_i, y_i, z_i, R_i = position[0, i], position[1, i], position[2, i], vapour_support[i]
        total = wide(poly6_pair(real(0), R_i))
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            if phase[j] != VAPOUR:
                continue
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            total += poly6_pair(x * x + y * y + z * z, real(0.5) * (R_i + vapour_support[j]))
        rho = vapour.mass * real(total)
        vapour_density[i] = rho
        vapour_pressure[i] = vapour.stiffness * max(rho - vapour.rest_density, real(0))


@cpu_stage
def vapour_force(
    position, phase, temperature, vapour_density, vapour_pressure, vapour_support, neighbour_count, neighbour_index,
    vapour, dt, velocity, vapour_push,
):
    """See `melt.reference.vapour.vapour_force`."""
    real = type(vapour.support)
    wide = position.dtype.type
    slow = real(1) / (real(1) + vapour.drag * dt)
    for i in prange(phase.shape[0]):
        if phase[i] != VAPOUR:
            continue
        x_i, y_i, z_i, R_i = position[0, i], position[1, i], position[2, i], vapour_support[i]
        p_i, fx, fy, fz = vapour_pressure[i], wide(0), wide(0), wide(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            if phase[j] != VAPOUR:
                continue
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            f = spiky_pair_over_r(x * x + y * y + z * z, real(0.5) * (R_i + vapour_support[j]), vapour)
            f *= vapour.mass * (p_i + vapour_pressure[j]) / (real(2) * vapour_density[j])
            fx += f * x
            fy += f * y
            fz += f * z
        gx, gy, gz = real(fx), real(fy), real(fz)
        per_density, warm = real(1) / vapour_density[i], temperature[i] - vapour.air_temperature
        velocity[0, i] = slow * (velocity[0, i] + dt * (per_density * gx + vapour.buoyancy_x * warm))
        velocity[1, i] = slow * (velocity[1, i] + dt * (per_density * gy + vapour.buoyancy_y * warm))
        velocity[2, i] = slow * (velocity[2, i] + dt * (per_density * gz + vapour.buoyancy_z * warm))
        vapour_push[i] = math.sqrt(gx * gx + gy * gy + gz * gz)


@cpu_stage
def vapour_move(velocity, bubbles, vapour, dt, phase, position, age):
    """See `melt.reference.vapour.vapour_move`."""
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != VAPOUR:
            continue
        x = position[0, i] + wide(dt) * wide(velocity[0, i])
        y = position[1, i] + wide(dt) * wide(velocity[1, i])
        z = position[2, i] + wide(dt) * wide(velocity[2, i])
        position[0, i] = min(max(x, wide(bubbles.lower_x)), wide(bubbles.upper_x))
        position[1, i] = min(max(y, wide(bubbles.lower_y)), wide(bubbles.upper_y))
        position[2, i] = min(max(z, wide(bubbles.lower_z)), wide(bubbles.upper_z))
        age[i] += dt
        phase[i] = INACTIVE if age[i] > vapour.life else VAPOUR


@cpu_stage
def vapour_precision(phase, vapour_density, vapour_push, neighbour_count, neighbour_index, vapour, vapour_support):
    """See `melt.reference.vapour.vapour_precision`."""
    for i in prange(phase.shape[0]):
        if phase[i] != VAPOUR:
            continue
        densest, strongest = vapour_density[i], vapour_push[i]
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            if phase[j] == VAPOUR:
                densest, strongest = max(densest, vapour_density[j]), max(strongest, vapour_push[j])
        vapour_support[i] = vapour_radius(vapour_density[i], densest, vapour_push[i], strongest, vapour)  # (16)
