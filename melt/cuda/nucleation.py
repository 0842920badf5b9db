"""CUDA twin of `melt.reference.nucleation`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID, SOLID


@cuda_kernel
def _could(
    phase, material, temperature, latent_energy, latent_capacity, neighbour_count, neighbour_index,
    material_melting_point, material_freezes_to,
    change, nucleation,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    nucleation[i] = 0
    if phase[i] != LIQUID or material_freezes_to[material[i]] < 0:
        return
    point = material_melting_point[material_freezes_to[material[i]]]
    could = temperature[i] <= point - change.hysteresis
    if change.latent and latent_capacity[i] > 0:  # the plateau is the hysteresis
        could = latent_energy[i] <= 0 and temperature[i] <= point
    if could:
        for k in range(neighbour_count[i]):
            could = could and phase[neighbour_index[i, k]] != SOLID
    nucleation[i] = 1 if could else 0


@cuda_kernel
def _does(id, neighbour_count, neighbour_index, nucleation):
    # own bit 2 beside the others' bit 1: a word is written by its owner only
    i = cuda.grid(1)
    if i >= nucleation.shape[0] or nucleation[i] & 1 == 0:
        return
    first = True
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        first = first and (nucleation[j] & 1 == 0 or id[j] > id[i])
    nucleation[i] |= 2 if first else 0


def nucleus_choice(
    id, phase, material, temperature, latent_energy, latent_capacity, neighbour_count, neighbour_index,
    material_melting_point, material_freezes_to,
    change, nucleation,
):
    """See `melt.reference.nucleation.nucleus_choice`."""
    n = phase.shape[0]
    _could.launch(
        n, phase, material, temperature, latent_energy, latent_capacity, neighbour_count, neighbour_index,
        material_melting_point, material_freezes_to, change, nucleation,
    )
    _does.launch(n, id, neighbour_count, neighbour_index, nucleation)


@cuda_kernel
def _free(nucleus_sites, site_link_count, nucleus_free):
    b = cuda.grid(1)
    if b >= nucleus_sites.shape[1]:
        return
    live = 0
    for s in range(nucleus_sites[0, b], nucleus_sites[1, b]):
        live += site_link_count[s]
    nucleus_free[b] = 1 if live == 0 else 0


@cuda_kernel
def _count(nucleation, nucleus_count):
    piece = cuda.grid(1)
    pieces, n = nucleus_count.shape[0], nucleation.shape[0]
    if piece >= pieces:
        return
    total = 0
    for i in range(n * piece // pieces, n * (piece + 1) // pieces):
        total += 1 if nucleation[i] == 3 else 0
    nucleus_count[piece] = total


@cuda_kernel
def _take(nucleation, nucleus_sites, nucleus_free, nucleus_count, freeze_site, claim, region_rotation, nucleated):
    # a piece of the particles skips the bodies of those before it
    piece = cuda.grid(1)
    pieces, n, bodies = nucleated.shape[0], nucleation.shape[0], nucleus_sites.shape[1]
    if piece >= pieces:
        return
    real = region_rotation.dtype.type
    skip, taken, b = 0, 0, 0
    for p in range(piece):
        skip += nucleus_count[p]
    for i in range(n * piece // pieces, n * (piece + 1) // pieces):
        if nucleation[i] != 3:
            continue
        while b < bodies and (nucleus_free[b] == 0 or skip > 0):
            skip -= nucleus_free[b]
            b += 1
        if b < bodies:
            s = (nucleus_sites[0, b] + nucleus_sites[1, b]) // 2
            freeze_site[i] = s
            claim[s] = i
            for a in range(4):
                region_rotation[a, s] = real(1) if a == 0 else real(0)
            taken += 1
            b += 1
    nucleated[piece] = taken


def nucleus_claim(
    nucleation, nucleus_sites, site_link_count, freeze_site, claim, region_rotation, nucleated, nucleus_count,
    nucleus_free,
):
    """See `melt.reference.nucleation.nucleus_claim`."""
    pieces = nucleated.shape[0]
    _free.launch(nucleus_sites.shape[1], nucleus_sites, site_link_count, nucleus_free)
    _count.launch(pieces, nucleation, nucleus_count)
    _take.launch(
        pieces, nucleation, nucleus_sites, nucleus_free, nucleus_count, freeze_site, claim, region_rotation, nucleated
    )
