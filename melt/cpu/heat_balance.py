"""CPU twin of `melt.reference.heat_balance`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.heat import absorb, pair_factor, pair_weight


@cpu_stage
def heat_conductance(
    position, conductivity, heat_volume, neighbour_count, neighbour_index, smoothing, heat, heat_conductance,
):
    """See `melt.reference.heat_cg.heat_conductance`."""
    real = type(smoothing.support)
    for i in prange(conductivity.shape[0]):
        V, K = heat_volume[i], conductivity[i]
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        for entry in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, entry])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            r = math.sqrt(x * x + y * y + z * z)
            w = pair_weight(r, V, heat_volume[j], real(1), smoothing)
            heat_conductance[i, entry] = pair_factor(w, K, conductivity[j], real(0), heat)


@cpu_stage
def heat_balance(
    temperature, temperature_next, latent_energy, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, heat_conductance, neighbour_count, neighbour_index, heat, dt, heat_flux, heat_error,
):
    """See `melt.reference.heat_cg.heat_balance`."""
    real = type(dt)
    inf = real(math.inf)
    n = temperature.shape[0]
    for share in prange(64):
        worst, low, high = real(0), inf, -inf
        for i in range(share * n // 64, (share + 1) * n // 64):
            guess, flux, T = temperature_next[i], real(0), temperature[i]
            for entry in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, entry])
                flux += heat_conductance[i, entry] * (temperature_next[j] - guess)
            q = real(0) if heat_capacity[i] == inf else dt * flux
            heat_flux[i] = q
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


@cpu_stage
def heat_finish(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_flux, heat, temperature,
    latent_energy,
):
    """See `melt.reference.heat_cg.heat_finish`."""
    real = type(heat.spacing)
    for i in prange(temperature.shape[0]):
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
