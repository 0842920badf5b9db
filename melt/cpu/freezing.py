"""CPU twin of `melt.reference.freezing`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.params import REFILL_ALL
from melt.physics.phases import LIQUID, SOLID
from melt.physics.quaternion import rotate

PIECES = 64
FAR = 2**30


@cpu_stage
def freeze_choice(
    position, velocity, phase, material, temperature, latent_energy, latent_capacity, site, site_adjacent,
    site_link_count,
    neighbour_count, neighbour_index, region_rotation, region_shift, material_melting_point,
    material_freezes_to,
    lattice, change, dt, freeze_site, freeze_distance, freeze_shift,
):
    """See `melt.reference.freezing.freeze_choice`."""
    real = type(lattice.spacing)
    dx = lattice.spacing
    slow = real(0.5) * dx / dt
    for i in prange(phase.shape[0]):
        freeze_site[i] = -1
        freeze_distance[i] = 0
        freeze_shift[0, i] = real(0)
        freeze_shift[1, i] = real(0)
        freeze_shift[2, i] = real(0)
        if phase[i] != LIQUID or material_freezes_to[material[i]] < 0:
            continue
        point = material_melting_point[material_freezes_to[material[i]]]
        cold = temperature[i] <= point - change.hysteresis
        if change.latent and latent_capacity[i] > 0:  # the plateau is the hysteresis
            cold = latent_energy[i] <= 0 and temperature[i] <= point
        if not cold:
            continue
        best, taken = FAR, -1
        for n in range(neighbour_count[i]):
            j = neighbour_index[i, n]
            q = site[j]
            if phase[j] != SOLID or q < 0 or site_link_count[q] == 0:
                continue
            u = velocity[0, i] - velocity[0, j]
            v = velocity[1, i] - velocity[1, j]
            w = velocity[2, i] - velocity[2, j]
            if not math.sqrt(u * u + v * v + w * w) < slow:
                continue
            x = real(position[0, j] - position[0, i]) + region_shift[0, q]
            y = real(position[1, j] - position[1, i]) + region_shift[1, q]
            z = real(position[2, j] - position[2, i]) + region_shift[2, q]
            for k in range(27):
                s = site_adjacent[q, k]
                if s < 0 or site_link_count[s] > 0:
                    continue
                r = rotate(
                    region_rotation[0, q], region_rotation[1, q], region_rotation[2, q], region_rotation[3,
                    q],
                    real(k % 3 - 1) * dx, real(k // 3 % 3 - 1) * dx, real(k // 9 - 1) * dx,
                )
                a, b, c = x + r[0], y + r[1], z + r[2]
                d = math.sqrt(a * a + b * b + c * c)
                if d < change.reach:
                    key = int(math.floor(d / change.reach * real(4096) + real(0.5)))
                    if key < best or (key == best and s < taken):
                        best, taken = key, s
                        freeze_shift[0, i], freeze_shift[1, i], freeze_shift[2, i] = a, b, c
        if taken >= 0:
            freeze_site[i] = taken
            freeze_distance[i] = best


@cpu_stage
def freeze_claim(
    id, freeze_site, freeze_distance, site_particle, site_adjacent, site_link_count, neighbour_count,
    neighbour_index,
    claim, frozen,
):
    """See `melt.reference.freezing.freeze_claim`; who chose a site is listed by a live site beside it."""
    count = site_link_count.shape[0]
    for piece in prange(PIECES):
        total = 0
        for s in range(count * piece // PIECES, count * (piece + 1) // PIECES):
            winner = -1
            if site_link_count[s] == 0:
                for k in range(27):
                    q = site_adjacent[s, k]
                    if q < 0 or site_link_count[q] == 0:
                        continue
                    p = site_particle[q]
                    for n in range(neighbour_count[p]):
                        i = neighbour_index[p, n]
                        if freeze_site[i] != s:
                            continue
                        if (
                            winner < 0
                            or freeze_distance[i] < freeze_distance[winner]
                            or (freeze_distance[i] == freeze_distance[winner] and id[i] < id[winner])
                        ):
                            winner = i
            claim[s] = winner
            total += 1 if winner >= 0 else 0
        frozen[piece] = total


@cpu_stage
def freeze_particles(
    freeze_site, freeze_shift, claim, material_freezes_to, material_density, change, position, phase,
    material, site,
    mass, rest_volume, density,
):
    """See `melt.reference.freezing.freeze_particles`."""
    for i in prange(phase.shape[0]):
        s = freeze_site[i]
        if s >= 0 and claim[s] == i:
            row = material_freezes_to[material[i]]
            phase[i], site[i], material[i] = SOLID, s, row
            density[i] = material_density[row]
            for a in range(3):
                position[a, i] += freeze_shift[a, i]
            if change.own_liquid:
                rest_volume[i] = mass[i] / material_density[row]
            else:
                mass[i] = material_density[row] * rest_volume[i]
        elif phase[i] != SOLID and site[i] >= 0 and claim[site[i]] >= 0:
            site[i] = -1


@cpu_stage
def freeze_sites(claim, site_adjacent, site_particle, site_links, site_link_count, region_rotation):
    """See `melt.reference.freezing.freeze_sites`.

    Whether a neighbour was live is read from its link to itself, which only a claimed site changes.
    """
    for s in prange(claim.shape[0]):
        if claim[s] < 0 and site_links[s, 13] < 0:
            continue
        total = 0
        for k in range(26, -1, -1):
            q = site_adjacent[s, k]
            if q < 0:
                continue
            before = claim[q] < 0 and site_links[q, 13] >= 0
            if before or claim[q] >= 0:
                total += 1
                site_links[s, k] = q
            if before and claim[s] >= 0:
                for a in range(4):
                    region_rotation[a, s] = region_rotation[a, q]
        site_link_count[s] = total
        if claim[s] >= 0:
            site_particle[s] = claim[s]


@cpu_stage
def mark_frozen(claim, site_links, site_link_count, lattice, site_dirty, site_hops):
    """See `melt.reference.freezing.mark_frozen`: hops from the new sites, one layer per pass."""
    count = claim.shape[0]
    reach = 2 * np.int64(lattice.width)
    for s in prange(count):
        site_hops[s] = 0 if claim[s] >= 0 else FAR
    for hop in range(1, reach + 1):
        for s in prange(count):
            if site_hops[s] == FAR and site_link_count[s] > 0:
                for k in range(27):
                    j = site_links[s, k]
                    # a label written in this pass is not hop - 1: the order of sites does not matter
                    if j >= 0 and site_hops[j] == hop - 1:
                        site_hops[s] = hop
    for s in prange(count):
        refill = lattice.refill == REFILL_ALL or site_hops[s] <= lattice.width
        renew = lattice.refill == REFILL_ALL or site_hops[s] <= reach
        site_dirty[s] = (1 if refill else 0) + (2 if renew else 0)
