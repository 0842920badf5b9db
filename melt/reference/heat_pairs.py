"""Pairwise implicit heat exchange in lexicographic order. Melting paper eq (4), spec 2.5."""

import numpy as np

from melt.reference._enthalpy import Enthalpy, latent_of
from melt.reference._shares import rows


def heat_pairs_seq(
    phase, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, temperature, latent_energy,
):
    """Step every pair alone by backward Euler, forward with dt/2, then in exact reverse with dt/2.

    Order: i ascending, then j ascending over j > i; pairs with a wall stand with their
    mobile particle. ``heat.full_sweep`` gives each sweep dt (the paper's literal reading).

    Reads: phase (n,), C and enthalpy fields (n,), heat_conductance (n, capacity) [W/K].
    Writes: temperature (n,) [degC], latent_energy (n,) [J].
    """
    n = len(phase)
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    T, e = temperature.astype(np.float64), latent_of(heat, latent_energy, n)
    mobile = (phase != 2) & (phase != 5)
    order = [
        (i, j, float(G))
        for i, near in rows(neighbour_count, neighbour_index) if mobile[i]
        for j, G in sorted(zip(near, heat_conductance[i, : len(near)]))
        if phase[j] == 2 or (mobile[j] and j > i)
    ]
    step = float(dt) * (1.0 if heat.full_sweep else 0.5)
    for i, j, G in order + order[::-1]:
        curve.exchange(step * G, i, j, T, e)
    temperature[:] = T
    if heat.latent:
        latent_energy[:] = e
