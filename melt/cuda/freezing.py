"""CUDA twin of `melt.reference.freezing`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.params import REFILL_ALL
from melt.physics.phases import LIQUID, SOLID
from melt.physics.quaternion import rotate

FAR = 2**30


@cuda_kernel
def _freeze_choice(
    position, velocity, phase, material, temperature, latent_energy, latent_capacity, site, site_adjacent,
    site_link_count,
    neighbour_count, neighbour_index, region_rotation, region_shift, material_melting_point,
    material_freezes_to,
    lattice, change, dt, freeze_site, freeze_distance, freeze_shift,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(lattice.spacing)
    dx = lattice.spacing
    freeze_site[i] = -1
    freeze_distance[i] = 0
    freeze_shift[0, i] = real(0)
    freeze_shift[1, i] = real(0)
    freeze_shift[2, i] = real(0)
    if phase[i] != LIQUID or material_freezes_to[material[i]] < 0:
        return
    point = material_melting_point[material_freezes_to[material[i]]]
    cold = temperature[i] <= point - change.hysteresis
    if change.latent and latent_capacity[i] > 0:  # the plateau is the hysteresis
        cold = latent_energy[i] <= 0 and temperature[i] <= point
    if not cold:
        return
    best, taken = FAR, -1
    slow = real(0.5) * dx / dt
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
                region_rotation[0, q], region_rotation[1, q], region_rotation[2, q], region_rotation[3, q],
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


def freeze_choice(
    position, velocity, phase, material, temperature, latent_energy, latent_capacity, site, site_adjacent,
    site_link_count,
    neighbour_count, neighbour_index, region_rotation, region_shift, material_melting_point,
    material_freezes_to,
    lattice, change, dt, freeze_site, freeze_distance, freeze_shift,
):
    """See `melt.reference.freezing.freeze_choice`."""
    _freeze_choice.launch(
        phase.shape[0], position, velocity, phase, material, temperature, latent_energy, latent_capacity, site,
        site_adjacent,
        site_link_count, neighbour_count, neighbour_index, region_rotation, region_shift,
        material_melting_point,
        material_freezes_to, lattice, change, dt, freeze_site, freeze_distance, freeze_shift,
    )


@cuda_kernel
def _freeze_claim(
    id, freeze_site, freeze_distance, site_particle, site_adjacent, site_link_count, neighbour_count,
    neighbour_index,
    claim,
):
    s = cuda.grid(1)
    if s >= site_link_count.shape[0]:
        return
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


@cuda_kernel
def _count_claims(claim, frozen):
    t = cuda.grid(1)
    number = frozen.shape[0]
    if t >= number:
        return
    total = 0
    for s in range(claim.shape[0] * t // number, claim.shape[0] * (t + 1) // number):
        total += 1 if claim[s] >= 0 else 0
    frozen[t] = total


def freeze_claim(
    id, freeze_site, freeze_distance, site_particle, site_adjacent, site_link_count, neighbour_count,
    neighbour_index,
    claim, frozen,
):
    """See `melt.reference.freezing.freeze_claim`."""
    _freeze_claim.launch(
        site_link_count.shape[0], id, freeze_site, freeze_distance, site_particle, site_adjacent,
        site_link_count,
        neighbour_count, neighbour_index, claim,
    )
    _count_claims.launch(frozen.shape[0], claim, frozen)


@cuda_kernel
def _freeze_particles(
    freeze_site, freeze_shift, claim, material_freezes_to, material_density, change, position, phase,
    material, site,
    mass, rest_volume, density,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    s = freeze_site[i]
    if s >= 0 and claim[s] == i:
        row = material_freezes_to[material[i]]
        phase[i] = SOLID
        site[i] = s
        material[i] = row
        density[i] = material_density[row]
        for a in range(3):
            position[a, i] += freeze_shift[a, i]
        if change.own_liquid:
            rest_volume[i] = mass[i] / material_density[row]
        else:
            mass[i] = material_density[row] * rest_volume[i]
    elif phase[i] != SOLID and site[i] >= 0 and claim[site[i]] >= 0:
        site[i] = -1


def freeze_particles(
    freeze_site, freeze_shift, claim, material_freezes_to, material_density, change, position, phase,
    material, site,
    mass, rest_volume, density,
):
    """See `melt.reference.freezing.freeze_particles`."""
    _freeze_particles.launch(
        phase.shape[0], freeze_site, freeze_shift, claim, material_freezes_to, material_density, change,
        position,
        phase, material, site, mass, rest_volume, density,
    )


@cuda_kernel
def _freeze_sites(claim, site_adjacent, site_particle, site_links, site_link_count, region_rotation):
    # a neighbour was live if it links to itself, which only a claimed site changes
    s = cuda.grid(1)
    if s >= claim.shape[0] or (claim[s] < 0 and site_links[s, 13] < 0):
        return
    total = 0
    for r in range(27):
        k = 26 - r
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


def freeze_sites(claim, site_adjacent, site_particle, site_links, site_link_count, region_rotation):
    """See `melt.reference.freezing.freeze_sites`."""
    _freeze_sites.launch(
        claim.shape[0], claim, site_adjacent, site_particle, site_links, site_link_count, region_rotation
    )


@cuda_kernel
def _hop_start(claim, site_hops):
    s = cuda.grid(1)
    if s < claim.shape[0]:
        site_hops[s] = 0 if claim[s] >= 0 else FAR


@cuda_kernel
def _hop(site_links, site_link_count, hop, site_hops):
    s = cuda.grid(1)
    if s >= site_link_count.shape[0] or site_hops[s] != FAR or site_link_count[s] == 0:
        return
    for k in range(27):
        j = site_links[s, k]
        # a label written in this pass is not hop - 1: the order of sites does not matter
        if j >= 0 and site_hops[j] == hop - 1:
            site_hops[s] = hop


@cuda_kernel
def _mark_frozen(lattice, site_hops, site_dirty):
    s = cuda.grid(1)
    if s >= site_hops.shape[0]:
        return
    refill = lattice.refill == REFILL_ALL or site_hops[s] <= lattice.width
    renew = lattice.refill == REFILL_ALL or site_hops[s] <= 2 * lattice.width
    site_dirty[s] = (1 if refill else 0) + (2 if renew else 0)


def mark_frozen(claim, site_links, site_link_count, lattice, site_dirty, site_hops):
    """See `melt.reference.freezing.mark_frozen`."""
    sites = claim.shape[0]
    _hop_start.launch(sites, claim, site_hops)
    for hop in range(1, 2 * int(lattice.width) + 1):
        _hop.launch(sites, site_links, site_link_count, hop, site_hops)
    _mark_frozen.launch(sites, lattice, site_hops, site_dirty)
