"""CPU twin of `melt.reference.heat_cg`. Sums: 64 shares of particles, added in order."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.heat import absorb


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
    n = cg_residual.shape[0]
    for share in prange(64):  # fixed shares: a vectorised division and that of a loop's rest may round apart
        for i in range(share * n // 64, (share + 1) * n // 64):
            z = cg_residual[i] / cg_diagonal[i] if cg_diagonal[i] > real(0) else real(0)
            cg_direction[i] = z + b * cg_direction[i]
    for share in range(64):
        cg_sums[0, share] = cg_sums[2, share]
