"""New bodies in cold liquid far from any solid. Melting spec 3.4 (option, in its simplest form).

A nucleus is one particle that becomes solid where it is, as a body of one site in the voxel
frame's orientation; other particles then freeze to the sites around it as to any body. Spare
bodies (``nucleus_sites``) are kept for this from the start; one whose sites are all vacant is free.
"""

import numpy as np


def nucleus_choice(
    id, phase, material, temperature, latent_energy, latent_capacity, neighbour_count, neighbour_index,
    material_melting_point, material_freezes_to,
    change, nucleation,
):
    """Write which particles would start a body: bit 1 for every one that could, bit 2 for those that do.

    It could if it is a liquid particle cold enough to freeze (see `freeze_choice`) without a solid
    neighbour; of neighbours that could, the smallest id does. Two of a step are never neighbours.

    Reads: id, phase, material, temperature [degC], latent_energy, latent_capacity [J] (n,) (only with ``change.latent``),
        the neighbour list, material_melting_point [degC], material_freezes_to.
    Writes: nucleation (n,), 0, 1 or 3.
    """
    nucleation[:] = 0
    near = [neighbour_index[i, : neighbour_count[i]] for i in range(len(phase))]
    for i in np.flatnonzero(phase == 0):
        solid = material_freezes_to[material[i]]
        if solid < 0 or (phase[near[i]] == 1).any():
            continue
        point = material_melting_point[solid]
        nucleation[i] = latent_energy[i] <= 0 and temperature[i] <= point if (
            change.latent and latent_capacity[i] > 0
        ) else temperature[i] <= point - change.hysteresis
    could = nucleation == 1
    for i in np.flatnonzero(could):
        rivals = near[i][could[near[i]]]
        nucleation[i] = 3 if (id[rivals] > id[i]).all() else 1


def nucleus_claim(
    nucleation, nucleus_sites, site_link_count, freeze_site, claim, region_rotation, nucleated, nucleus_count,
    nucleus_free,
):
    """Give the free spare bodies to the particles that start one, both in ascending order.

    The particle takes the middle site of the body, whose rotation becomes the identity. What finds
    no free body stays liquid.

    Reads: nucleation (n,), nucleus_sites (2, b) first and last + 1 site of each spare body,
        site_link_count (s,).
    Writes: freeze_site (n,), claim (s,), region_rotation (4, s) of the taken sites and particles;
        nucleated (64,) counts them, piece by piece of the particles.
    """
    n = len(nucleation)
    free = [b for b, (first, end) in enumerate(nucleus_sites.T) if not site_link_count[first:end].any()]
    taken = np.zeros(n, bool)
    for i, b in zip(np.flatnonzero(nucleation == 3), free):
        s = nucleus_sites[:, b].sum() // 2
        freeze_site[i], claim[s], taken[i] = s, i, True
        region_rotation[:, s] = (1, 0, 0, 0)
    pieces = np.arange(65) * n // 64
    nucleated[:] = [taken[a:b].sum() for a, b in zip(pieces[:-1], pieces[1:])]
