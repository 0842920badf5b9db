"""Conductances, heat balance and flux form of an implicit step. Melting spec 2.5, 3.5.

    E_i^{n+1} = E_i^n + dt sum_j G_ij (T_j' - T_i')

is antisymmetric in every pair, so that the sum of E is kept to round-off however far T' was
iterated (`melt.reference.heat_cg`).
"""

import numpy as np

from melt.reference._enthalpy import Enthalpy, conductances
from melt.reference._shares import rows, shares


def heat_conductance(
    position, conductivity, heat_volume, neighbour_count, neighbour_index, smoothing, heat, heat_conductance,
):
    """Write G_ij = kappa_ij V_i V_j L_ij [W/K] of each list entry, shape (n, capacity)."""
    G = conductances(position, conductivity, heat_volume, smoothing, heat)
    for i, near in rows(neighbour_count, neighbour_index):
        heat_conductance[i, : len(near)] = G[i, near]


def heat_balance(
    temperature, temperature_next, latent_energy, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, heat_conductance, neighbour_count, neighbour_index, heat, dt, heat_flux, heat_error,
):
    """Write the heat that T' drives into each particle, and how far that is from T'.

    Writes: heat_flux (n,) [J] = dt sum_j G_ij (T_j' - T_i'); heat_error (3, 64) [K]: largest
        abs(T(E^n + heat_flux) - T'), lowest and highest of T^n and T' of particles with neighbours.
    """
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    T, guess = temperature.astype(float), temperature_next.astype(float)
    gap, low, high = (np.zeros(len(T)), np.full(len(T), np.inf), np.full(len(T), -np.inf))
    for i, near in rows(neighbour_count, neighbour_index):
        G = heat_conductance[i, : len(near)].astype(float)
        held = np.isinf(curve.C[i])
        heat_flux[i] = 0.0 if held else float(dt) * (G * (guess[near] - guess[i])).sum()
        e = float(latent_energy[i]) if heat.latent else 0.0
        gap[i] = abs(curve.absorb(i, float(heat_flux[i]), T[i], e)[0] - guess[i])
        gap[i] = gap[i] if np.isfinite(gap[i]) else np.inf
        if len(near):
            low[i], high[i] = min(T[i], guess[i]), max(T[i], guess[i])
    heat_error[0] = [s.max(initial=0.0) for s in shares(gap)]
    heat_error[1] = [s.min(initial=np.inf) for s in shares(low)]
    heat_error[2] = [s.max(initial=-np.inf) for s in shares(high)]


def heat_finish(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_flux, heat, temperature,
    latent_energy,
):
    """Write T^{n+1} and the latent energy of the enthalpy E^n + heat_flux."""
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    for i in range(len(temperature)):
        e = float(latent_energy[i]) if heat.latent else 0.0
        temperature[i], e = curve.absorb(i, float(heat_flux[i]), float(temperature[i]), e)
        if heat.latent:
            latent_energy[i] = e
