"""Heat exchange without partners' feedback: one-sided pairs and forward Euler. Melting spec 2.5."""

import numpy as np

from melt.reference._enthalpy import Enthalpy, conductances, latent_of


def heat_onesided(
    position, temperature, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
    latent_point, latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt, reverse,
    temperature_next, latent_energy,
):
    """One pass of eq (4) in which each particle updates only itself, from frozen neighbours.

    T_i runs through its neighbours in ascending (``reverse`` 0) or descending (1) order; the
    neighbours keep the values that they had at the start of the pass. This is most likely
    the paper's parallel kernel. Not conserving. A neighbour at its phase change point counts
    as held there.

    Reads: as `melt.reference.heat_pairs.heat_pairs_seq`, temperature (n,) [degC].
    Writes: temperature_next (n,) [degC], latent_energy (n,) [J] (only the particle's own).
    """
    n = len(temperature)
    G = conductances(position, conductivity, heat_volume, smoothing, heat)
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    point = np.where(curve.changes, curve.m, np.nan)
    start, e = temperature.astype(np.float64), latent_of(heat, latent_energy, n)
    for i in range(n):
        T_i = {i: start[i]}
        if np.asarray(neighbour_count)[i] > 0:
            near = np.flatnonzero(G[i] > 0)
            for j in near[::-1] if reverse > 0 else near:
                g = float(dt) * G[i, j]
                C_j = curve.C_molten[j] if curve.changes[j] and start[j] > curve.m[j] else curve.C[j]
                C_j = np.inf if start[j] == point[j] else C_j
                partner = Enthalpy(
                    heat, [curve.C[i], C_j], [curve.C_molten[i], C_j],
                    [curve.m[i], np.inf], [curve.L[i], 0.0],
                )
                T, own = [T_i[i], start[j]], [e[i], 0.0]
                partner.exchange(g, 0, 1, T, own)
                T_i[i], e[i] = T[0], own[0]
        temperature_next[i] = T_i[i]
    if heat.latent:
        latent_energy[:] = e


def heat_explicit(
    position, temperature, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
    latent_point, latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt,
    temperature_next, latent_energy,
):
    """Forward Euler: E_i += dt sum_j G_ij (T_j - T_i); stable for dt <= 1 / max(`heat_rate`).

    Reads: as `heat_onesided`. Writes: temperature_next (n,) [degC], latent_energy (n,) [J].
    """
    n = len(temperature)
    G = conductances(position, conductivity, heat_volume, smoothing, heat)
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    T, e = temperature.astype(np.float64), latent_of(heat, latent_energy, n)
    q = float(dt) * (G * (T[None, :] - T[:, None])).sum(axis=1)
    for i in range(n):
        temperature_next[i], e[i] = curve.absorb(i, q[i] if neighbour_count[i] > 0 else 0.0, T[i], e[i])
    if heat.latent:
        latent_energy[:] = e


def heat_rate(
    position, conductivity, heat_volume, heat_capacity, neighbour_count, neighbour_index,
    smoothing, heat, heat_rate,
):
    """Write the largest sum_j G_ij / C_i [1/s] of 64 equal shares of the particles."""
    G = conductances(position, conductivity, heat_volume, smoothing, heat).sum(axis=1)
    C = heat_capacity.astype(np.float64)
    rate = np.where((C > 0) & (np.asarray(neighbour_count) > 0), G / np.where(C > 0, C, 1.0), 0.0)
    n = len(rate)
    for k in range(64):
        heat_rate[k] = rate[k * n // 64:(k + 1) * n // 64].max(initial=0.0)
