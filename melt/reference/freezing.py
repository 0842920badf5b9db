r"""Freezing of liquid particles to vacant lattice sites. Melting spec 3.4.

Run at x^n, after `region_match` at x^n: a vacant site s beside a live site q of its body is at

.. math:: y = c_q + R_q (X^0_s - c^0_q) = x_q + \mathrm{shift}_q + R_q (o \, dx)

with the voxel offset o from q to s. A cold liquid particle chooses the nearest such site within
reach and slow enough relative to the particle at q; a site takes the nearest of those that chose
it. Distances are compared in 1/4096 of the reach, then by site and by ``id``: equal distances,
which are common on a lattice, are not decided by rounding.
"""

import numpy as np

from melt.reference._lattice import offsets, turn


def freeze_choice(
    position, velocity, phase, material, temperature, latent_energy, latent_capacity, site, site_adjacent,
    site_link_count,
    neighbour_count, neighbour_index, region_rotation, region_shift, material_melting_point,
    material_freezes_to,
    lattice, change, dt, freeze_site, freeze_distance, freeze_shift,
):
    """Write the vacant site that each liquid particle would freeze to, -1 for none.

    Cold means T <= T_melt - hysteresis of the solid it freezes to, or, with latent heat, all of it given off at
    T <= T_melt. A particle whose latent capacity is 0 keeps the hysteresis: it has no plateau to cross.
    It must not move by half a spacing in the sub-step dt [s] relative to the particle beside the site.

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase, material, temperature, latent_energy,
        latent_capacity (n,) (these two only with ``change.latent``), site (n,),
        site_adjacent (s, 27), site_link_count (s,), the neighbour list, region_rotation (4, s),
        region_shift (3, s) [m], material_melting_point and material_freezes_to.
    Writes: freeze_site (n,), freeze_distance (n,) in 1/4096 of the reach, freeze_shift (3, n) = y - x [m].
    """
    step = offsets(27) * float(lattice.spacing)
    freeze_site[:] = -1
    freeze_distance[:] = 0
    freeze_shift[:] = 0
    for i in np.flatnonzero(phase == 0):
        solid = material_freezes_to[material[i]]
        if solid < 0:
            continue
        point = material_melting_point[solid]
        cold = latent_energy[i] <= 0 and temperature[i] <= point if (
            change.latent and latent_capacity[i] > 0
        ) else temperature[i] <= point - change.hysteresis
        if not cold:
            continue
        best = None
        for j in neighbour_index[i, : neighbour_count[i]]:
            if phase[j] != 1 or site[j] < 0 or site_link_count[site[j]] == 0:
                continue
            if np.linalg.norm(velocity[:, i] - velocity[:, j]) >= 0.5 * lattice.spacing / dt:
                continue
            q = site[j]
            for k in np.flatnonzero(site_adjacent[q] >= 0):
                s = site_adjacent[q, k]
                if site_link_count[s] > 0:
                    continue
                y = region_shift[:, q] + turn(region_rotation[:, q].astype(float)) @ step[k]
                shift = position[:, j].astype(float) - position[:, i] + y
                d = np.linalg.norm(shift)
                if d < change.reach:
                    key = (int(np.floor(d / change.reach * 4096 + 0.5)), int(s))
                    if best is None or key < best:
                        best, freeze_shift[:, i] = key, shift
        if best is not None:
            freeze_distance[i], freeze_site[i] = best


def freeze_claim(
    id, freeze_site, freeze_distance, site_particle, site_adjacent, site_link_count, neighbour_count,
    neighbour_index,
    claim, frozen,
):
    """Write the particle that takes each vacant site, -1 for none: the nearest, then the smallest id.

    Reads: id, freeze_site, freeze_distance (n,), site_particle, site_link_count (s,), site_adjacent (s, 27).
    Writes: claim (s,), frozen (64,) counts them, piece by piece of the sites.
    """
    count = len(site_link_count)
    claim[:] = -1
    for i in np.flatnonzero(freeze_site >= 0):
        s = freeze_site[i]
        if claim[s] < 0 or (freeze_distance[i], id[i]) < (freeze_distance[claim[s]], id[claim[s]]):
            claim[s] = i
    pieces = np.arange(65) * count // 64
    frozen[:] = [(claim[a:b] >= 0).sum() for a, b in zip(pieces[:-1], pieces[1:])]


def freeze_particles(
    freeze_site, freeze_shift, claim, material_freezes_to, material_density, change, position, phase,
    material, site,
    mass, rest_volume, density,
):
    """Make solid of the particles that won a site; a liquid particle that had it before forgets it.

    The particle is put on its site with its velocity kept: left where it was, the next goal would
    fetch it in one sub-step, at up to 0.6 dx / dts (measured: 40 m/s and a burst body).

    Own liquid: mass stays, V0 = m / rho_solid. Ambient liquid: V0 stays, m = rho_solid V0.

    Reads: freeze_site (n,), freeze_shift (3, n) [m], claim (s,), material_freezes_to, material_density.
    Writes: position (3, n) [m], phase, material, site (n,), mass (n,) [kg], rest_volume (n,) [m^3],
        density (n,) [kg/m^3] (at rest).
    """
    for i in range(len(phase)):
        s = freeze_site[i]
        if s >= 0 and claim[s] == i:
            phase[i], site[i] = 1, s
            position[:, i] += freeze_shift[:, i]
            material[i] = material_freezes_to[material[i]]
            density[i] = material_density[material[i]]
            if change.own_liquid:
                rest_volume[i] = mass[i] / material_density[material[i]]
            else:
                mass[i] = material_density[material[i]] * rest_volume[i]
        elif phase[i] != 1 and site[i] >= 0 and claim[site[i]] >= 0:
            site[i] = -1


def freeze_sites(claim, site_adjacent, site_particle, site_links, site_link_count, region_rotation):
    """Link the claimed sites with their live neighbours, both ways; they start with a neighbour's rotation.

    Reads: claim (s,), site_adjacent (s, 27).
    Writes: site_particle (s,), site_links (s, 27), site_link_count (s,), region_rotation (4, s).
    """
    before = site_link_count > 0
    live = before | (claim >= 0)
    table = np.where((site_adjacent >= 0) & live[:, None], site_adjacent, -1)
    table = np.where((table >= 0) & live[np.maximum(table, 0)], table, -1)
    for s in np.flatnonzero(claim >= 0):
        site_particle[s] = claim[s]
        hosts = [q for q in table[s] if q >= 0 and before[q]]
        if hosts:
            region_rotation[:, s] = region_rotation[:, hosts[0]]
    site_links[:] = table
    site_link_count[:] = (table >= 0).sum(axis=1)


def mark_frozen(claim, site_links, site_link_count, lattice, site_dirty, site_hops):
    """Write which regions must be refilled (bit 1: within w hops of a new site) and renewed (bit 2: 2w).

    Reads: claim (s,), site_links (s, 27), site_link_count (s,). Writes: site_dirty (s,).
    """
    w = int(lattice.width)
    new = claim >= 0
    reached = new.copy()
    site_dirty[:] = 0
    for hop in range(2 * w + 1):
        site_dirty[reached] |= 3 if hop <= w else 2
        reached = reached | ((site_links >= 0) & reached[np.maximum(site_links, 0)]).any(axis=1)
    if lattice.refill == 0:
        site_dirty[:] = 3
