"""CPU twin of `melt.reference.phase_change`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.phases import LIQUID, SOLID

PIECES = 64


@cpu_stage
def melt_test(
    material, temperature, latent_energy, latent_capacity, site_particle, site_link_count,
    material_melting_point, lattice, change, site_melting, melted,
):
    """See `melt.reference.phase_change.melt_test`."""
    count = site_particle.shape[0]
    for piece in prange(PIECES):
        total = 0
        for s in range(count * piece // PIECES, count * (piece + 1) // PIECES):
            melts = False
            if site_link_count[s] > 0 and site_link_count[s] < lattice.connect + 1:
                p = site_particle[s]
                melts = temperature[p] >= material_melting_point[material[p]]
                if change.latent:
                    melts = melts and latent_energy[p] >= latent_capacity[p]
            site_melting[s] = 1 if melts else 0
            total += 1 if melts else 0
        melted[piece] = total


@cpu_stage
def melt_particles(
    site, site_melting, material_melts_to, material_density, change, phase, material, mass, rest_volume, density,
):
    """See `melt.reference.phase_change.melt_particles`."""
    for i in prange(phase.shape[0]):
        s = site[i]
        if phase[i] != SOLID or s < 0 or site_melting[np.uint64(s)] == 0:
            continue
        row = material_melts_to[material[i]]
        phase[i] = LIQUID
        material[i] = row
        density[i] = material_density[row]
        if change.own_liquid:
            rest_volume[i] = mass[i] / material_density[row]
        else:
            mass[i] = material_density[row] * rest_volume[i]
