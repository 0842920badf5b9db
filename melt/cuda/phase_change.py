"""CUDA twin of `melt.reference.phase_change`."""

from melt._compile import cuda, cuda_kernel
from melt.cuda._count import count_pieces
from melt.physics.phases import LIQUID, SOLID


@cuda_kernel
def _melt_test(
    material, temperature, latent_energy, latent_capacity, site_particle, site_link_count,
    material_melting_point, lattice, change, site_melting,
):
    s = cuda.grid(1)
    if s >= site_particle.shape[0]:
        return
    melts = False
    if site_link_count[s] > 0 and site_link_count[s] < lattice.connect + 1:
        p = site_particle[s]
        melts = temperature[p] >= material_melting_point[material[p]]
        if change.latent:
            melts = melts and latent_energy[p] >= latent_capacity[p]
    site_melting[s] = 1 if melts else 0


def melt_test(
    material, temperature, latent_energy, latent_capacity, site_particle, site_link_count,
    material_melting_point, lattice, change, site_melting, melted,
):
    """See `melt.reference.phase_change.melt_test`."""
    _melt_test.launch(
        site_particle.shape[0], material, temperature, latent_energy, latent_capacity, site_particle,
        site_link_count, material_melting_point, lattice, change, site_melting,
    )
    count_pieces.launch(melted.shape[0], site_melting, melted)


@cuda_kernel
def _melt_particles(
    site, site_melting, material_melts_to, material_density, change, phase, material, mass, rest_volume, density,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    s = site[i]
    if phase[i] != SOLID or s < 0 or site_melting[s] == 0:
        return
    row = material_melts_to[material[i]]
    phase[i] = LIQUID
    material[i] = row
    density[i] = material_density[row]
    if change.own_liquid:
        rest_volume[i] = mass[i] / material_density[row]
    else:
        mass[i] = material_density[row] * rest_volume[i]


def melt_particles(
    site, site_melting, material_melts_to, material_density, change, phase, material, mass, rest_volume, density,
):
    """See `melt.reference.phase_change.melt_particles`."""
    _melt_particles.launch(
        phase.shape[0], site, site_melting, material_melts_to, material_density, change, phase, material,
        mass, rest_volume, density,
    )
