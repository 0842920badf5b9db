"""Melting of single particles. Melting spec 3.1 rules 2, 3, 4, 6.

A solid particle with a live neighbour at every bonding voxel (27 counting itself, connect 26)
is interior; others are on the surface. Only surface particles melt, all on the temperatures and
links of the start of the step: at most one layer per step.
"""

import numpy as np


def melt_test(
    material, temperature, latent_energy, latent_capacity, site_particle, site_link_count,
    material_melting_point, lattice, change, site_melting, melted,
):
    """Write which sites melt: on the surface and T >= T_melt, and with latent heat all of it absorbed.

    Reads: material, temperature (n,) [degC], latent_energy and latent_capacity (n,) [J] (only
        with ``change.latent``), site_particle and site_link_count (s,), material_melting_point [degC].
    Writes: site_melting (s,); melted (64,) counts them, piece by piece of the sites.
    """
    site_melting[:] = 0
    for s in np.flatnonzero((site_link_count > 0) & (site_link_count < lattice.connect + 1)):
        p = site_particle[s]
        hot = temperature[p] >= material_melting_point[material[p]]
        filled = not change.latent or latent_energy[p] >= latent_capacity[p]
        site_melting[s] = hot and filled
    pieces = np.arange(65) * len(site_melting) // 64
    melted[:] = [site_melting[a:b].sum() for a, b in zip(pieces[:-1], pieces[1:])]


def melt_particles(
    site, site_melting, material_melts_to, material_density, change, phase, material, mass, rest_volume, density,
):
    """Make liquid of the particles whose site melts; position, velocity, temperature, site stay.

    Without latent heat (off, or 0) the physical law has C = m c_liquid from then on at the same T: the enthalpy
    from the melting point jumps by (c_liquid - c_solid) m (T - T_m). With it C is c_liquid above T_m already.

    Own liquid: the mass stays and V0 = m / rho_liquid. Ambient liquid (the paper): V0 stays and
    m = rho_liquid V0, so mass is not conserved.

    Reads: site (n,), site_melting (s,), material_melts_to and material_density [kg/m^3].
    Writes: phase, material (n,), mass (n,) [kg], rest_volume (n,) [m^3] and density (n,)
        [kg/m^3] (at rest, until the next density pass) of the melting particles.
    """
    for i in np.flatnonzero((phase == 1) & (site >= 0)):
        if not site_melting[site[i]]:
            continue
        phase[i] = 0
        material[i] = material_melts_to[material[i]]
        rho = density[i] = material_density[material[i]]
        if change.own_liquid:
            rest_volume[i] = mass[i] / rho
        else:
            mass[i] = rho * rest_volume[i]
