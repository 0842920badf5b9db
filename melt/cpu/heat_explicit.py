"""CPU twin of `melt.reference.heat_explicit`."""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.heat import absorb, own_share, pair_latent

_CHUNKS = 64


@cpu_stage
def heat_onesided(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, reverse, temperature_next, latent_energy,
):
    """See `melt.reference.heat_explicit.heat_onesided`.

    A row is a chain u += f_k (u_k - u), u = T - T_i at the start (so that equal temperatures
    stay equal). Its links u -> a u + b are made in SIMD lanes, then its two halves run side by
    side: the second one from 0, its product of a applied to the first one's result.
    """
    n = temperature.shape[0]
    for chunk in prange(_CHUNKS):
        keep = np.empty(neighbour_index.shape[1], temperature.dtype)
        gain = np.empty(neighbour_index.shape[1], temperature.dtype)
        for i in range(n * chunk // _CHUNKS, n * (chunk + 1) // _CHUNKS):
            if heat.latent != 0:
                _latent_row(
                    i, temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity,
                    heat_conductance, neighbour_count, neighbour_index, dt, reverse, temperature_next, latent_energy,
                )
                continue
            if heat_capacity[i] == math.inf:
                temperature_next[i] = temperature[i]
                continue
            _links(i, temperature, heat_capacity, heat_conductance, neighbour_count, neighbour_index, dt, keep, gain)
            temperature_next[i] = temperature[i] + _chain(keep, gain, np.uint64(neighbour_count[i]), reverse > 0)


@cpu_helper
def _links(i, temperature, heat_capacity, heat_conductance, neighbour_count, neighbour_index, dt, keep, gain):
    """Write a = 1 - f and b = f (T_j - T_i), f = q / (D C_i), of the row of particle i."""
    one = type(dt)(1)
    T, C = temperature[i], heat_capacity[i]
    for entry in range(np.uint64(neighbour_count[i])):
        j = np.uint64(neighbour_index[i, entry])
        f = own_share(dt * heat_conductance[i, entry], C, heat_capacity[j])
        keep[entry] = one - f
        gain[entry] = f * (temperature[j] - T)


@cpu_helper
def _chain(keep, gain, count, back):
    """Return u at the end of the chain that starts at u = 0."""
    first = second = keep.dtype.type(0)
    product = keep.dtype.type(1)
    half, last = count // np.uint64(2), count - np.uint64(1)
    if back:
        for k in range(half):
            p, q = last - k, last - half - k
            first = keep[p] * first + gain[p]
            second = keep[q] * second + gain[q]
            product *= keep[q]
    else:
        for k in range(half):
            first = keep[k] * first + gain[k]
            second = keep[half + k] * second + gain[half + k]
            product *= keep[half + k]
    u = product * first + second
    if count > half + half:  # the odd one comes last
        odd = np.uint64(0) if back else last
        u = keep[odd] * u + gain[odd]
    return u


@cpu_helper
def _latent_row(
    i, temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, dt, reverse, temperature_next, latent_energy,
):
    """Update particle i with latent heat: the enthalpy curve makes the whole pair a chain."""
    real = type(dt)
    inf, zero = real(math.inf), real(0)
    T, count = temperature[i], neighbour_count[i]
    e = latent_energy[i]
    for entry in range(count):
        slot = count - 1 - entry if reverse > zero else entry
        j = neighbour_index[i, slot]
        T_j, C_j = temperature[j], heat_capacity[j]
        if latent_capacity[j] > zero and T_j == latent_point[j]:
            C_j = inf  # on its plateau
        elif latent_capacity[j] > zero and T_j > latent_point[j] and C_j < inf:
            C_j = heat_capacity_molten[j]
        T, e, _, _ = pair_latent(
            dt * heat_conductance[i, slot], T, e, latent_point[i], heat_capacity[i], heat_capacity_molten[i],
            latent_capacity[i], T_j, zero, inf, C_j, C_j, zero,
        )
    temperature_next[i] = T
    latent_energy[i] = e


@cpu_stage
def heat_explicit(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, temperature_next, latent_energy,
):
    """See `melt.reference.heat_explicit.heat_explicit`."""
    real = type(dt)
    for i in prange(temperature.shape[0]):
        T, q = temperature[i], real(0)
        for entry in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, entry])
            q += heat_conductance[i, entry] * (temperature[j] - T)
        q *= dt
        if heat.latent == 0:
            temperature_next[i] = T if q == real(0) else T + q / heat_capacity[i]
            continue
        T, e = absorb(
            q, T, latent_energy[i], latent_point[i], heat_capacity[i], heat_capacity_molten[i],
            latent_capacity[i],
        )
        temperature_next[i] = T
        latent_energy[i] = e


@cpu_stage
def heat_rate(heat_capacity, latent_capacity, heat_capacity_molten, heat_conductance, neighbour_count, heat, heat_rate):
    """See `melt.reference.heat_explicit.heat_rate`."""
    real = heat_rate.dtype.type
    n = heat_capacity.shape[0]
    for share in prange(64):
        largest = real(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            total = real(0)
            for entry in range(np.uint64(neighbour_count[i])):
                total += heat_conductance[i, entry]
            C = heat_capacity[i]
            if heat.latent != 0 and latent_capacity[i] > real(0):
                C = min(C, heat_capacity_molten[i])
            if total > real(0):
                largest = max(largest, total / C)
        heat_rate[share] = largest
