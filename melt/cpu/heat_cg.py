"""CPU twin of `melt.reference.heat_cg`. Sums: 64 shares of particles, added in order."""

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
def cg_guess(temperature, temperature_next, heat_flux):
    """See `melt.reference.heat_cg.cg_guess`."""
    for i in prange(temperature.shape[0]):
        temperature_next[i] = temperature[i]
        heat_flux[i] = temperature.dtype.type(0)


@cpu_stage
def cg_state(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy,
    heat_flux, heat, temperature_next, heat_linear, heat_excess,
):
    """See `melt.reference.heat_cg.cg_state`."""
    real = type(heat.spacing)
    inf = real(math.inf)
    for i in prange(temperature.shape[0]):
        T, guess, C = temperature[i], temperature_next[i], heat_capacity[i]
        if C == inf:
            temperature_next[i] = T
            heat_linear[i] = inf
            heat_excess[i] = real(0)
            continue
        if heat.latent == 0 or not latent_capacity[i] > real(0):
            heat_linear[i] = C
            heat_excess[i] = C * (T - guess)
            continue
        e, m, molten, L = latent_energy[i], latent_point[i], heat_capacity_molten[i], latent_capacity[i]
        now, _ = absorb(heat_flux[i], T, e, m, C, molten, L)
        if now == m:
            temperature_next[i] = m
            heat_linear[i] = inf
            heat_excess[i] = real(0)
            continue
        E = e + (T - m) * (C if T < m else molten)
        if now < m:
            guess = min(guess, m)
            heat_linear[i] = C
            heat_excess[i] = E - C * (guess - m)
        else:
            guess = max(guess, m)
            heat_linear[i] = molten
            heat_excess[i] = E - L - molten * (guess - m)
        temperature_next[i] = guess


@cpu_stage
def cg_start(
    temperature_next, heat_linear, heat_excess, heat_conductance, neighbour_count, neighbour_index, dt,
    cg_residual, cg_direction, cg_diagonal, cg_sums,
):
    """See `melt.reference.heat_cg.cg_start`."""
    real = type(dt)
    n = heat_linear.shape[0]
    for share in prange(64):
        total = real(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            T, flux, G = temperature_next[i], real(0), real(0)
            for entry in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, entry])
                flux += heat_conductance[i, entry] * (temperature_next[j] - T)
                G += heat_conductance[i, entry]
            held = heat_linear[i] == real(math.inf)
            r = real(0) if held else heat_excess[i] + dt * flux
            diagonal = heat_linear[i] + dt * G
            p = r / diagonal if diagonal > real(0) else real(0)
            cg_residual[i] = r
            cg_diagonal[i] = diagonal
            cg_direction[i] = p
            total += r * p
        cg_sums[0, share] = total


@cpu_stage
def cg_apply(
    cg_direction, heat_linear, heat_conductance, neighbour_count, neighbour_index, dt, cg_product, cg_sums,
):
    """See `melt.reference.heat_cg.cg_apply`."""
    real = type(dt)
    n = heat_linear.shape[0]
    for share in prange(64):
        total = real(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            p, flux, C = cg_direction[i], real(0), heat_linear[i]
            for entry in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, entry])
                flux += heat_conductance[i, entry] * (p - cg_direction[j])
            product = real(0) if C == real(math.inf) else C * p + dt * flux
            cg_product[i] = product
            total += p * product
        cg_sums[1, share] = total


@cpu_stage
def cg_step(cg_direction, cg_product, cg_diagonal, temperature_next, cg_residual, cg_sums):
    """See `melt.reference.heat_cg.cg_step`."""
    real = cg_residual.dtype.type
    n = cg_residual.shape[0]
    old, curvature = real(0), real(0)
    for share in range(64):
        old += cg_sums[0, share]
        curvature += cg_sums[1, share]
    a = old / curvature if curvature > real(0) else real(0)
    for share in prange(64):
        total = real(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            temperature_next[i] += a * cg_direction[i]
            r = cg_residual[i] - a * cg_product[i]
            cg_residual[i] = r
            if cg_diagonal[i] > real(0):
                total += r * (r / cg_diagonal[i])
        cg_sums[2, share] = total


@cpu_stage
def cg_turn(cg_residual, cg_diagonal, cg_direction, cg_sums):
    """See `melt.reference.heat_cg.cg_turn`."""
    real = cg_residual.dtype.type
    old, new = real(0), real(0)
    for share in range(64):
        old += cg_sums[0, share]
        new += cg_sums[2, share]
    b = new / old if old > real(0) else real(0)
    for i in prange(cg_residual.shape[0]):
        z = cg_residual[i] / cg_diagonal[i] if cg_diagonal[i] > real(0) else real(0)
        cg_direction[i] = z + b * cg_direction[i]
    for share in range(64):
        cg_sums[0, share] = cg_sums[2, share]


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
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_flux, heat, temperature, latent_energy,
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
