"""CPU twin of `melt.reference.boil_heat`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.boiling import approach, gain, heat_weight, heated, viscosity_laplacian
from melt.physics.pbf import support_of
from melt.physics.phases import LIQUID

PIECES = 64


@cpu_stage
def boil_sums(position, phase, rest_volume, support_radius, neighbour_count, neighbour_index, pbf, heat_sum):
    """See `melt.reference.boil_heat.boil_sums`."""
    real = type(pbf.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        total = wide(0)
        for k in range(np.uint64(neighbour_count[i] if phase[i] == LIQUID else 0)):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            r2 = x * x + y * y + z * z
            f = rest_volume[j] * r2 * viscosity_laplacian(r2, support_of(i, j, support_radius, pbf))
            total += f if phase[j] == LIQUID else real(0)
        heat_sum[i] = real(1 / 6) * real(total)


@cpu_stage
def boil_rate(
    position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index, pbf, boiling,
    heat_rate,
):
    """See `melt.reference.boil_heat.boil_rate`."""
    real = type(pbf.support)
    wide = position.dtype.type
    n = phase.shape[0]
    for piece in prange(PIECES):
        largest = real(0)
        for i in range(np.uint64(n * piece // PIECES), np.uint64(n * (piece + 1) // PIECES)):
            x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
            total = wide(0)
            for k in range(np.uint64(neighbour_count[i] if phase[i] == LIQUID else 0)):
                j = np.uint64(neighbour_index[i, k])
                x = real(x_i - position[0, j])
                y = real(y_i - position[1, j])
                z = real(z_i - position[2, j])
                R = support_of(i, j, support_radius, pbf)
                f = heat_weight(i, j, x * x + y * y + z * z, R, rest_volume[j], heat_sum, constraint, boiling)
                total += f if phase[j] == LIQUID else real(0)
            rate = boiling.diffusivity * real(total)
            # a NaN would lose every comparison that follows; infinity wins them
            largest = max(largest, rate if rate == rate else real(np.inf))
        heat_rate[piece] = largest


@cpu_stage
def boil_exchange(
    temperature, position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index,
    pbf, boiling, dt, temperature_next,
):
    """See `melt.reference.boil_heat.boil_exchange`."""
    real = type(pbf.support)
    wide = position.dtype.type
    step = dt * boiling.diffusivity
    for i in prange(phase.shape[0]):
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        T_i = temperature[i]
        total = wide(0)
        for k in range(np.uint64(neighbour_count[i] if phase[i] == LIQUID else 0)):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            R = support_of(i, j, support_radius, pbf)
            f = heat_weight(i, j, x * x + y * y + z * z, R, rest_volume[j], heat_sum, constraint, boiling)
            f = f if phase[j] == LIQUID else real(0)
            total += f * (temperature[j] - T_i)  # (10), (11)
        temperature_next[i] = T_i + step * real(total)


@cpu_stage
def boil_heater(position, phase, mass, bubbles, boiling, target, share, temperature, heater_heat):
    """See `melt.reference.boil_heat.boil_heater`."""
    wide = position.dtype.type
    n = phase.shape[0]
    c_p = np.float64(boiling.specific_heat)
    for piece in prange(PIECES):
        heat = np.float64(0)
        for i in range(np.uint64(n * piece // PIECES), np.uint64(n * (piece + 1) // PIECES)):
            height = position[2, i] - wide(bubbles.floor)
            if phase[i] == LIQUID and height < wide(boiling.contact) and heated(position[0, i], position[1, i], boiling):
                before = temperature[i]
                after = approach(before, target, share)
                temperature[i] = after
                heat += np.float64(mass[i]) * c_p * gain(np.float64(before), np.float64(after))
        heater_heat[piece] = heat


@cpu_stage
def boil_cooling(position, phase, mass, bubbles, boiling, target, share, height, temperature, lost_heat):
    """See `melt.reference.boil_heat.boil_cooling`."""
    wide = position.dtype.type
    n = phase.shape[0]
    c_p = np.float64(boiling.specific_heat)
    for piece in prange(PIECES):
        heat = np.float64(0)
        for i in range(np.uint64(n * piece // PIECES), np.uint64(n * (piece + 1) // PIECES)):
            if phase[i] == LIQUID and position[2, i] - wide(bubbles.floor) >= wide(height):
                before = temperature[i]
                after = approach(before, target, share)
                temperature[i] = after
                heat += np.float64(mass[i]) * c_p * gain(np.float64(after), np.float64(before))
        lost_heat[piece] = heat


@cpu_stage
def boil_store(phase, boiling, temperature, latent_store):
    """See `melt.reference.boil_heat.boil_store`."""
    T_b = boiling.boiling_point
    for i in prange(phase.shape[0]):
        if phase[i] == LIQUID and temperature[i] > T_b:
            latent_store[i] += boiling.specific_heat * (temperature[i] - T_b)
            temperature[i] = T_b


@cpu_stage
def boil_content(phase, mass, temperature, latent_store, boiling, boil_content):
    """See `melt.reference.boil_heat.boil_content`."""
    n = phase.shape[0]
    c_p = np.float64(boiling.specific_heat)
    for piece in prange(PIECES):
        heat = np.float64(0)
        for i in range(np.uint64(n * piece // PIECES), np.uint64(n * (piece + 1) // PIECES)):
            e = np.float64(mass[i]) * (c_p * np.float64(temperature[i]) + np.float64(latent_store[i]))
            heat += e if phase[i] == LIQUID else np.float64(0)
        boil_content[piece] = heat
