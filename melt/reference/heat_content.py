"""Heat content of liquids and solids, for the ledger of what sources bring. Melting spec 8 (ledgers)."""

import numpy as np


def heat_content(
    phase, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy, heat,
    heat_content,
):
    """Write the sum of the enthalpies, C T (above a melting point C T_m + C_molten (T - T_m)) + latent energy.

    Liquids and solids of finite heat capacity count. 64 pieces of the particles, each a sum and what
    its rounding left out: the sources of one step are a small difference of large sums.

    Reads: phase (n,), the enthalpy fields of `melt.reference.heat.latent_properties` (with latent heat).
    Writes: heat_content (2, 64) [J].
    """
    n = len(phase)
    T, C = temperature.astype(np.float64), heat_capacity.astype(np.float64)
    counts = ((phase == 0) | (phase == 1)) & np.isfinite(C)
    E = np.where(counts, np.where(counts, C, 0.0) * T, 0.0)
    if heat.latent:
        above = (latent_capacity > 0) & (T > latent_point)
        point = np.where(above, latent_point, 0.0)
        E = np.where(counts & above, np.where(counts, C, 0.0) * point + heat_capacity_molten * (T - point), E)
        E = np.where(counts, E + latent_energy, 0.0)
    pieces = np.arange(65) * n // 64
    heat_content[0] = [E[a:b].sum() for a, b in zip(pieces[:-1], pieces[1:])]
    heat_content[1] = 0
