"""CUDA twin of `melt.reference.boil_heat`."""

import numpy as np

from melt._compile import cuda, cuda_kernel, device_empty
from melt.physics.boiling import approach, gain, heat_weight, heated, viscosity_laplacian
from melt.physics.pbf import support_of
from melt.physics.phases import LIQUID


@cuda_kernel
def _boil_sums(position, phase, rest_volume, support_radius, neighbour_count, neighbour_index, pbf, heat_sum):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    total = wide(0)
    for k in range(neighbour_count[i] if phase[i] == LIQUID else 0):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        r2 = x * x + y * y + z * z
        f = rest_volume[j] * r2 * viscosity_laplacian(r2, support_of(i, j, support_radius, pbf))
        total += f if phase[j] == LIQUID else real(0)
    heat_sum[i] = real(1 / 6) * real(total)


def boil_sums(position, phase, rest_volume, support_radius, neighbour_count, neighbour_index, pbf, heat_sum):
    """See `melt.reference.boil_heat.boil_sums`."""
    _boil_sums.launch(
        phase.shape[0], position, phase, rest_volume, support_radius, neighbour_count, neighbour_index, pbf, heat_sum,
    )


@cuda_kernel
def _particle_rate(
    position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index, pbf, boiling,
    rate,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    total = wide(0)
    for k in range(neighbour_count[i] if phase[i] == LIQUID else 0):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        R = support_of(i, j, support_radius, pbf)
        f = heat_weight(i, j, x * x + y * y + z * z, R, rest_volume[j], heat_sum, constraint, boiling)
        total += f if phase[j] == LIQUID else real(0)
    rate[i] = boiling.diffusivity * real(total)


@cuda_kernel
def _largest_rate(rate, heat_rate):
    p = cuda.grid(1)
    n, pieces = rate.shape[0], heat_rate.shape[0]
    if p >= pieces:
        return
    real = rate.dtype.type
    largest = real(0)
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        # a NaN would lose every comparison that follows; infinity wins them
        largest = max(largest, rate[i] if rate[i] == rate[i] else real(np.inf))
    heat_rate[p] = largest


def boil_rate(
    position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index, pbf, boiling,
    heat_rate,
):
    """See `melt.reference.boil_heat.boil_rate`."""
    rate = device_empty(phase.shape, rest_volume.dtype)
    _particle_rate.launch(
        phase.shape[0], position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count,
        neighbour_index, pbf, boiling, rate,
    )
    _largest_rate.launch(heat_rate.shape[0], rate, heat_rate)


@cuda_kernel
def _boil_exchange(
    temperature, position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index,
    pbf, boiling, dt, temperature_next,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    T_i = temperature[i]
    total = wide(0)
    for k in range(neighbour_count[i] if phase[i] == LIQUID else 0):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        R = support_of(i, j, support_radius, pbf)
        f = heat_weight(i, j, x * x + y * y + z * z, R, rest_volume[j], heat_sum, constraint, boiling)
        f = f if phase[j] == LIQUID else real(0)
        total += f * (temperature[j] - T_i)  # (10), (11)
    temperature_next[i] = T_i + dt * boiling.diffusivity * real(total)


def boil_exchange(
    temperature, position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index,
    pbf, boiling, dt, temperature_next,
):
    """See `melt.reference.boil_heat.boil_exchange`."""
    _boil_exchange.launch(
        phase.shape[0], temperature, position, phase, rest_volume, constraint, support_radius, heat_sum,
        neighbour_count, neighbour_index, pbf, boiling, dt, temperature_next,
    )


@cuda_kernel
def _boil_heater(position, phase, mass, bubbles, boiling, target, share, temperature, heater_heat):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], heater_heat.shape[0]
    if p >= pieces:
        return
    wide = position.dtype.type
    c_p = np.float64(boiling.specific_heat)
    heat = np.float64(0)
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        height = position[2, i] - wide(bubbles.floor)
        if phase[i] == LIQUID and height < wide(boiling.contact) and heated(position[0, i], position[1, i], boiling):
            before = temperature[i]
            after = approach(before, target, share)
            temperature[i] = after
            heat += np.float64(mass[i]) * c_p * gain(np.float64(before), np.float64(after))
    heater_heat[p] = heat


def boil_heater(position, phase, mass, bubbles, boiling, target, share, temperature, heater_heat):
    """See `melt.reference.boil_heat.boil_heater`."""
    _boil_heater.launch(
        heater_heat.shape[0], position, phase, mass, bubbles, boiling, target, share, temperature, heater_heat,
    )


@cuda_kernel
def _boil_cooling(position, phase, mass, bubbles, boiling, target, share, height, temperature, lost_heat):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], lost_heat.shape[0]
    if p >= pieces:
        return
    wide = position.dtype.type
    c_p = np.float64(boiling.specific_heat)
    heat = np.float64(0)
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        if phase[i] == LIQUID and position[2, i] - wide(bubbles.floor) >= wide(height):
            before = temperature[i]
            after = approach(before, target, share)
            temperature[i] = after
            heat += np.float64(mass[i]) * c_p * gain(np.float64(after), np.float64(before))
    lost_heat[p] = heat


def boil_cooling(position, phase, mass, bubbles, boiling, target, share, height, temperature, lost_heat):
    """See `melt.reference.boil_heat.boil_cooling`."""
    _boil_cooling.launch(
        lost_heat.shape[0], position, phase, mass, bubbles, boiling, target, share, height, temperature, lost_heat,
    )


@cuda_kernel
def _boil_store(phase, boiling, temperature, latent_store):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    T_b = boiling.boiling_point
    if phase[i] == LIQUID and temperature[i] > T_b:
        latent_store[i] += boiling.specific_heat * (temperature[i] - T_b)
        temperature[i] = T_b


def boil_store(phase, boiling, temperature, latent_store):
    """See `melt.reference.boil_heat.boil_store`."""
    _boil_store.launch(phase.shape[0], phase, boiling, temperature, latent_store)


@cuda_kernel
def _boil_content(phase, mass, temperature, latent_store, boiling, boil_content):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], boil_content.shape[0]
    if p >= pieces:
        return
    c_p = np.float64(boiling.specific_heat)
    heat = np.float64(0)
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        if phase[i] == LIQUID:
            heat += np.float64(mass[i]) * (c_p * np.float64(temperature[i]) + np.float64(latent_store[i]))
    boil_content[p] = heat


def boil_content(phase, mass, temperature, latent_store, boiling, boil_content):
    """See `melt.reference.boil_heat.boil_content`."""
    _boil_content.launch(boil_content.shape[0], phase, mass, temperature, latent_store, boiling, boil_content)
