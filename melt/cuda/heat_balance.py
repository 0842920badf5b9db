"""CUDA twin of `melt.reference.heat_balance`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.heat import absorb, pair_factor, pair_weight


@cuda_kernel
def _heat_conductance(
    position, conductivity, heat_volume, neighbour_count, neighbour_index, smoothing, heat, heat_conductance,
):
    i = cuda.grid(1)
    if i >= conductivity.shape[0]:
        return
    real = type(smoothing.support)
    V, K = heat_volume[i], conductivity[i]
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    for entry in range(neighbour_count[i]):
        j = neighbour_index[i, entry]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        r = math.sqrt(x * x + y * y + z * z)
        w = pair_weight(r, V, heat_volume[j], real(1), smoothing)
        heat_conductance[i, entry] = pair_factor(w, K, conductivity[j], real(0), heat)


def heat_conductance(
    position, conductivity, heat_volume, neighbour_count, neighbour_index, smoothing, heat, heat_conductance,
):
    """See `melt.reference.heat_cg.heat_conductance`."""
    _heat_conductance.launch(
        conductivity.shape[0], position, conductivity, heat_volume, neighbour_count, neighbour_index,
        smoothing, heat, heat_conductance,
    )


@cuda_kernel
def _heat_finish(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_flux, heat, temperature,
    latent_energy,
):
    i = cuda.grid(1)
    if i >= temperature.shape[0]:
        return
    real = type(heat.spacing)
    q = heat_flux[i]
    if heat.latent != 0:
        T, e = absorb(
            q, temperature[i], latent_energy[i], latent_point[i], heat_capacity[i],
            heat_capacity_molten[i], latent_capacity[i],
        )
        temperature[i] = T
        latent_energy[i] = e
    elif q != real(0):
        temperature[i] += q / heat_capacity[i]


def heat_finish(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_flux, heat, temperature,
    latent_energy,
):
    """See `melt.reference.heat_cg.heat_finish`."""
    _heat_finish.launch(
        temperature.shape[0], heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_flux,
        heat, temperature, latent_energy,
    )


@cuda_kernel
def _heat_flux(
    temperature_next, heat_capacity, heat_conductance, neighbour_count, neighbour_index, dt, heat_flux,
):
    i = cuda.grid(1)
    if i >= temperature_next.shape[0]:
        return
    real = type(dt)
    guess, flux = temperature_next[i], real(0)
    for entry in range(neighbour_count[i]):
        j = neighbour_index[i, entry]
        flux += heat_conductance[i, entry] * (temperature_next[j] - guess)
    heat_flux[i] = real(0) if heat_capacity[i] == real(math.inf) else dt * flux


@cuda_kernel
def _heat_error(
    temperature, temperature_next, latent_energy, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, neighbour_count, heat, heat_flux, heat_error,
):
    share = cuda.grid(1)
    if share >= 64:
        return
    real = type(heat.spacing)
    inf = real(math.inf)
    n = temperature.shape[0]
    worst, low, high = real(0), inf, -inf
    for i in range(share * n // 64, (share + 1) * n // 64):
        guess, q, T = temperature_next[i], heat_flux[i], temperature[i]
        if heat.latent != 0:
            new, _ = absorb(
                q, T, latent_energy[i], latent_point[i], heat_capacity[i], heat_capacity_molten[i],
                latent_capacity[i],
            )
        else:
            new = T if q == real(0) else T + q / heat_capacity[i]
        gap = abs(new - guess)
        worst = max(worst, gap if gap < inf else inf)
        if neighbour_count[i] > 0:
            low = min(low, min(T, guess))
            high = max(high, max(T, guess))
    heat_error[0, share] = worst
    heat_error[1, share] = low
    heat_error[2, share] = high


def heat_balance(
    temperature, temperature_next, latent_energy, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, heat_conductance, neighbour_count, neighbour_index, heat, dt, heat_flux, heat_error,
):
    """See `melt.reference.heat_cg.heat_balance`."""
    _heat_flux.launch(
        temperature.shape[0], temperature_next, heat_capacity, heat_conductance, neighbour_count,
        neighbour_index, dt, heat_flux,
    )
    _heat_error.launch(
        64, temperature, temperature_next, latent_energy, heat_capacity, heat_capacity_molten, latent_point,
        latent_capacity, neighbour_count, heat, heat_flux, heat_error,
    )
