"""Heat exchange without partners' feedback: one-sided pairs and forward Euler. Melting spec 2.5."""

import numpy as np

from melt.reference._enthalpy import Enthalpy, latent_of
from melt.reference._shares import rows, shares


def heat_onesided(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, reverse, temperature_next, latent_energy,
):
    """One pass of eq (4) in which each particle updates only itself, from frozen neighbours.

    T_i runs through its neighbours in ascending (``reverse`` 0) or descending (1) order; the
    neighbours keep the values that they had at the start of the pass. This is most likely
    the paper's parallel kernel. Not conserving. A neighbour at its phase change point counts
    as held there.

    Reads: temperature (n,) [degC], heat_conductance (n, capacity) [W/K], enthalpy fields (n,).
    Writes: temperature_next (n,) [degC], latent_energy (n,) [J] (only the particle's own).
    """
    n = len(temperature)
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    point = np.where(curve.changes, curve.m, np.nan)
    start, e = temperature.astype(np.float64), latent_of(heat, latent_energy, n)
    for i, near in rows(neighbour_count, neighbour_index):
        T_i = start[i]
        entries = list(zip(near, heat_conductance[i, : len(near)].astype(float)))
        for j, G in entries[::-1] if reverse > 0 else entries:
            C_j = curve.C_molten[j] if curve.changes[j] and start[j] > curve.m[j] else curve.C[j]
            C_j = np.inf if start[j] == point[j] else C_j
            partner = Enthalpy(
                heat, [curve.C[i], C_j], [curve.C_molten[i], C_j],
                [curve.m[i], np.inf], [curve.L[i], 0.0],
            )
            T, own = [T_i, start[j]], [e[i], 0.0]
            partner.exchange(float(dt) * G, 0, 1, T, own)
            T_i, e[i] = T[0], own[0]
        temperature_next[i] = T_i
    if heat.latent:
        latent_energy[:] = e


def heat_explicit(
    temperature, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, temperature_next, latent_energy,
):
    """Forward Euler: E_i += dt sum_j G_ij (T_j - T_i); stable for dt <= 1 / max(`heat_rate`).

    Reads: as `heat_onesided`. Writes: temperature_next (n,) [degC], latent_energy (n,) [J].
    """
    n = len(temperature)
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    T, e = temperature.astype(np.float64), latent_of(heat, latent_energy, n)
    for i, near in rows(neighbour_count, neighbour_index):
        q = float(dt) * (heat_conductance[i, : len(near)].astype(float) * (T[near] - T[i])).sum()
        temperature_next[i], e[i] = curve.absorb(i, q, T[i], e[i])
    if heat.latent:
        latent_energy[:] = e


def heat_rate(heat_capacity, latent_capacity, heat_capacity_molten, heat_conductance, neighbour_count, heat, heat_rate):
    """Write the largest sum_j G_ij / C_i [1/s] of 64 equal shares of the particles."""
    G = np.array([heat_conductance[i, :k].astype(float).sum() for i, k in enumerate(neighbour_count)])
    C = heat_capacity.astype(float)
    if heat.latent:  # the slope dT/dE is steepest where the capacity is least
        C = np.where(latent_capacity > 0, np.minimum(C, heat_capacity_molten), C)
    rate = np.where(G > 0, G / np.where(C > 0, C, np.inf), 0.0)
    heat_rate[:] = [s.max(initial=0.0) for s in shares(rate)]
