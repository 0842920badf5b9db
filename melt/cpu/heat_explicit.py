"""CPU twin of `melt.reference.heat_explicit`."""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.heat import absorb, pair_factor, pair_latent, pair_weight

_CHUNKS = 64


@cpu_stage
def heat_onesided(
    position, temperature, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
    latent_point, latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt, reverse,
    temperature_next, latent_energy,
):
    """See `melt.reference.heat_explicit.heat_onesided`.

    Only T += f (T_j - T) is a chain: the factors f of a row are made first, in SIMD lanes
    (measured: a third of the time of one loop).
    """
    n = temperature.shape[0]
    for chunk in prange(_CHUNKS):
        factors = np.empty(neighbour_index.shape[1], temperature.dtype)
        others = np.empty(neighbour_index.shape[1], temperature.dtype)
        for i in range(n * chunk // _CHUNKS, n * (chunk + 1) // _CHUNKS):
            if heat.latent != 0:
                _latent_row(
                    i, position, temperature, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
                    latent_point, latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt, reverse,
                    temperature_next, latent_energy,
                )
                continue
            count = neighbour_count[i]
            _row_factors(
                i, position, temperature, conductivity, heat_volume, heat_capacity, count, neighbour_index,
                smoothing, heat, dt, factors, others,
            )
            T = temperature[i]
            if reverse > 0:
                for entry in range(count - 1, -1, -1):
                    T += factors[entry] * (others[entry] - T)
            else:
                for entry in range(count):
                    T += factors[entry] * (others[entry] - T)
            temperature_next[i] = T


@cpu_helper
def _row_factors(
    i, position, temperature, conductivity, heat_volume, heat_capacity, count, neighbour_index,
    smoothing, heat, dt, factors, others,
):
    """Write f = q / (D C_i) and T_j of the row of particle i."""
    real = type(smoothing.support)
    zero, one = real(0), real(1)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    K, V, flow = conductivity[i], heat_volume[i], one / heat_capacity[i]
    for entry in range(np.uint64(count)):
        j = np.uint64(neighbour_index[i, entry])
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        w = pair_weight(math.sqrt(x * x + y * y + z * z), V, heat_volume[j], dt, smoothing)
        f = pair_factor(w, K, conductivity[j], flow + one / heat_capacity[j], heat) * flow
        factors[entry] = f if w > zero else zero
        others[entry] = temperature[j]


@cpu_helper
def _latent_row(
    i, position, temperature, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
    latent_point, latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt, reverse,
    temperature_next, latent_energy,
):
    """Update particle i with latent heat: the enthalpy curve makes the whole pair a chain."""
    real = type(smoothing.support)
    inf, zero = real(math.inf), real(0)
    T, count = temperature[i], neighbour_count[i]
    e = latent_energy[i]
    for entry in range(count):
        j = neighbour_index[i, count - 1 - entry if reverse > zero else entry]
        x = real(position[0, i] - position[0, j])
        y = real(position[1, i] - position[1, j])
        z = real(position[2, i] - position[2, j])
        w = pair_weight(math.sqrt(x * x + y * y + z * z), heat_volume[i], heat_volume[j], dt, smoothing)
        if w == zero:
            continue
        T_j, C_j = temperature[j], heat_capacity[j]
        if latent_capacity[j] > zero and T_j == latent_point[j]:
            C_j = inf  # on its plateau
        elif latent_capacity[j] > zero and T_j > latent_point[j] and C_j < inf:
            C_j = heat_capacity_molten[j]
        g = pair_factor(w, conductivity[i], conductivity[j], zero, heat)
        T, e, _, _ = pair_latent(
            g, T, e, latent_point[i], heat_capacity[i], heat_capacity_molten[i], latent_capacity[i],
            T_j, zero, inf, C_j, C_j, zero,
        )
    temperature_next[i] = T
    latent_energy[i] = e


@cpu_stage
def heat_explicit(
    position, temperature, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
    latent_point, latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt,
    temperature_next, latent_energy,
):
    """See `melt.reference.heat_explicit.heat_explicit`."""
    real = type(smoothing.support)
    for i in prange(temperature.shape[0]):
        T = temperature[i]
        V, K = heat_volume[i], conductivity[i]
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        q = real(0)
        for entry in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, entry])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            r = math.sqrt(x * x + y * y + z * z)
            w = pair_weight(r, V, heat_volume[j], dt, smoothing)
            q += pair_factor(w, K, conductivity[j], real(0), heat) * (temperature[j] - T)
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
def heat_rate(
    position, conductivity, heat_volume, heat_capacity, neighbour_count, neighbour_index,
    smoothing, heat, heat_rate,
):
    """See `melt.reference.heat_explicit.heat_rate`."""
    real = type(smoothing.support)
    n = heat_volume.shape[0]
    for share in prange(64):
        largest = real(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            V, K = heat_volume[i], conductivity[i]
            x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
            total = real(0)
            for entry in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, entry])
                x = real(x_i - position[0, j])
                y = real(y_i - position[1, j])
                z = real(z_i - position[2, j])
                r = math.sqrt(x * x + y * y + z * z)
                w = pair_weight(r, V, heat_volume[j], real(1), smoothing)
                total += pair_factor(w, K, conductivity[j], real(0), heat)
            if total > real(0):
                largest = max(largest, total / heat_capacity[i])
        heat_rate[share] = largest
