"""CUDA twin of `melt.reference.heat_explicit`."""

import math

from melt._compile import cuda, cuda_kernel, device_empty
from melt.physics.heat import absorb, own_share, pair_latent


@cuda_kernel
def _heat_onesided(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, reverse, temperature_next, latent_energy,
):
    i = cuda.grid(1)
    if i >= temperature.shape[0]:
        return
    real = type(dt)
    inf, zero = real(math.inf), real(0)
    T, count, C = temperature[i], neighbour_count[i], heat_capacity[i]
    e = latent_energy[i] if heat.latent != 0 else zero
    for entry in range(count):
        slot = count - 1 - entry if reverse > zero else entry
        j = neighbour_index[i, slot]
        g = dt * heat_conductance[i, slot]
        T_j, C_j = temperature[j], heat_capacity[j]
        if heat.latent == 0:
            T += own_share(g, C, C_j) * (T_j - T) if C < inf else zero
            continue
        if latent_capacity[j] > zero and T_j == latent_point[j]:
            C_j = inf  # on its plateau
        elif latent_capacity[j] > zero and T_j > latent_point[j] and C_j < inf:
            C_j = heat_capacity_molten[j]
        T, e, _, _ = pair_latent(
            g, T, e, latent_point[i], heat_capacity[i], heat_capacity_molten[i], latent_capacity[i],
            T_j, zero, inf, C_j, C_j, zero,
        )
    temperature_next[i] = T
    if heat.latent != 0:
        latent_energy[i] = e


def heat_onesided(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, reverse, temperature_next, latent_energy,
):
    """See `melt.reference.heat_explicit.heat_onesided`."""
    _heat_onesided.launch(
        temperature.shape[0], temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity,
        heat_conductance, neighbour_count, neighbour_index, heat, dt, reverse, temperature_next, latent_energy,
    )


@cuda_kernel
def _heat_explicit(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, temperature_next, latent_energy,
):
    i = cuda.grid(1)
    if i >= temperature.shape[0]:
        return
    real = type(dt)
    T, q = temperature[i], real(0)
    for entry in range(neighbour_count[i]):
        q += heat_conductance[i, entry] * (temperature[neighbour_index[i, entry]] - T)
    q *= dt
    if heat.latent == 0:
        temperature_next[i] = T if q == real(0) else T + q / heat_capacity[i]
        return
    T, e = absorb(
        q, T, latent_energy[i], latent_point[i], heat_capacity[i], heat_capacity_molten[i], latent_capacity[i]
    )
    temperature_next[i] = T
    latent_energy[i] = e


def heat_explicit(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, temperature_next, latent_energy,
):
    """See `melt.reference.heat_explicit.heat_explicit`."""
    _heat_explicit.launch(
        temperature.shape[0], temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity,
        heat_conductance, neighbour_count, neighbour_index, heat, dt, temperature_next, latent_energy,
    )


@cuda_kernel
def _particle_rate(
    heat_capacity, latent_capacity, heat_capacity_molten, heat_conductance, neighbour_count, heat, rate,
):
    i = cuda.grid(1)
    if i >= heat_capacity.shape[0]:
        return
    real = rate.dtype.type
    total = real(0)
    for entry in range(neighbour_count[i]):
        total += heat_conductance[i, entry]
    C = heat_capacity[i]
    if heat.latent != 0 and latent_capacity[i] > real(0):
        C = min(C, heat_capacity_molten[i])
    rate[i] = total / C if total > real(0) else real(0)


@cuda_kernel
def _largest(rate, heat_rate):
    share = cuda.grid(1)
    if share >= 64:
        return
    n = rate.shape[0]
    largest = rate.dtype.type(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        largest = max(largest, rate[i])
    heat_rate[share] = largest


def heat_rate(heat_capacity, latent_capacity, heat_capacity_molten, heat_conductance, neighbour_count, heat, heat_rate):
    """See `melt.reference.heat_explicit.heat_rate`."""
    rate = device_empty(heat_capacity.shape, heat_capacity.dtype)
    _particle_rate.launch(
        heat_capacity.shape[0], heat_capacity, latent_capacity, heat_capacity_molten, heat_conductance,
        neighbour_count, heat, rate,
    )
    _largest.launch(64, rate, heat_rate)
