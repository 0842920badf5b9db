"""Pairwise implicit heat exchange in lexicographic order. Melting paper eq (4), spec 2.5."""

import numpy as np

from melt.reference._enthalpy import Enthalpy, conductances, latent_of


def heat_pairs_seq(
    position, phase, conductivity, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt, temperature, latent_energy,
):
    """Step every pair alone by backward Euler, forward with dt/2, then in exact reverse with dt/2.

    Order: i ascending, then j ascending over j > i; pairs with a wall stand with their
    mobile particle. ``heat.full_sweep`` gives each sweep dt (the paper's literal reading).

    Reads: position (3, n) [m], phase (n,), k, V, C and enthalpy fields (n,); the neighbour list
        is not used (all pairs).
    Writes: temperature (n,) [degC], latent_energy (n,) [J].
    """
    n = len(phase)
    G = conductances(position, conductivity, heat_volume, smoothing, heat)
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    T, e = temperature.astype(np.float64), latent_of(heat, latent_energy, n)
    mobile = (phase != 2) & (phase != 5)
    order = [
        (i, j) for i in range(n) if mobile[i] for j in range(n)
        if G[i, j] > 0 and (phase[j] == 2 or (mobile[j] and j > i))
    ]
    step = float(dt) * (1.0 if heat.full_sweep else 0.5)
    for i, j in order + order[::-1]:
        curve.exchange(step * G[i, j], i, j, T, e)
    temperature[:] = T
    if heat.latent:
        latent_energy[:] = e
