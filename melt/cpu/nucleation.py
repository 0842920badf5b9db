"""CPU twin of `melt.reference.nucleation`."""

from melt._compile import cpu_stage, prange
from melt.physics.phases import LIQUID, SOLID

PIECES = 64


@cpu_stage
def nucleus_choice(
    id, phase, material, temperature, latent_energy, latent_capacity, neighbour_count, neighbour_index,
    material_melting_point, material_freezes_to,
    change, nucleation,
):
    """See `melt.reference.nucleation.nucleus_choice`."""
    for i in prange(phase.shape[0]):
        nucleation[i] = 0
        if phase[i] != LIQUID or material_freezes_to[material[i]] < 0:
            continue
        point = material_melting_point[material_freezes_to[material[i]]]
        could = temperature[i] <= point - change.hysteresis
        if change.latent and latent_capacity[i] > 0:  # the plateau is the hysteresis
            could = latent_energy[i] <= 0 and temperature[i] <= point
        if could:
            for k in range(neighbour_count[i]):
                could = could and phase[neighbour_index[i, k]] != SOLID
        nucleation[i] = 1 if could else 0
    # own bit 2 beside the others' bit 1: a word is written by its owner only
    for i in prange(phase.shape[0]):
        if nucleation[i] & 1:
            first = True
            for k in range(neighbour_count[i]):
                j = neighbour_index[i, k]
                first = first and (nucleation[j] & 1 == 0 or id[j] > id[i])
            nucleation[i] |= 2 if first else 0


@cpu_stage
def nucleus_claim(
    nucleation, nucleus_sites, site_link_count, freeze_site, claim, region_rotation, nucleated, nucleus_count,
    nucleus_free,
):
    """See `melt.reference.nucleation.nucleus_claim`; a piece skips the bodies of those before it."""
    real = region_rotation.dtype.type
    n, bodies = nucleation.shape[0], nucleus_sites.shape[1]
    for b in prange(bodies):
        live = 0
        for s in range(nucleus_sites[0, b], nucleus_sites[1, b]):
            live += site_link_count[s]
        nucleus_free[b] = 1 if live == 0 else 0
    for piece in prange(PIECES):
        total = 0
        for i in range(n * piece // PIECES, n * (piece + 1) // PIECES):
            total += 1 if nucleation[i] == 3 else 0
        nucleus_count[piece] = total
    for piece in prange(PIECES):
        skip, taken, b = 0, 0, 0
        for p in range(piece):
            skip += nucleus_count[p]
        for i in range(n * piece // PIECES, n * (piece + 1) // PIECES):
            if nucleation[i] != 3:
                continue
            while b < bodies and (nucleus_free[b] == 0 or skip > 0):
                skip -= nucleus_free[b]
                b += 1
            if b < bodies:
                s = (nucleus_sites[0, b] + nucleus_sites[1, b]) // 2
                freeze_site[i], claim[s] = s, i
                for a in range(4):
                    region_rotation[a, s] = real(1) if a == 0 else real(0)
                taken += 1
                b += 1
        nucleated[piece] = taken
