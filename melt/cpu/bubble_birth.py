"""CPU twin of `melt.reference.bubble_birth`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.params import MASS_NUCLEATE
from melt.physics.bubble_life import boil_excess
from melt.physics.bubbles import inside, sphere_volume
from melt.physics.phases import BUBBLE, INACTIVE, LIQUID
from melt.physics.philox import ball_offset, random_words


@cpu_stage
def boil_candidates(id, phase, temperature, latent_store, boiling, step_low, step_high, candidate):
    """See `melt.reference.bubble_birth.boil_candidates`."""
    for i in prange(phase.shape[0]):
        boils = 0
        if phase[i] == LIQUID and temperature[i] >= boiling.boiling_point and latent_store[i] >= boiling.latent_heat:
            word, _, _, _ = random_words(id[i], step_low, step_high, 0, boiling.seed_low, boiling.seed_high, 1)
            boils = 1 if np.int64(word >> np.uint64(2)) < boiling.threshold else 0
        candidate[i] = boils


@cpu_stage
def boiled_sums(birth_index, mass, temperature, latent_store, latent_energy, boiling, served, boiled_sums):
    """See `melt.reference.bubble_birth.boiled_sums`."""
    pieces = boiled_sums.shape[1]
    c_p = np.float64(boiling.specific_heat)
    fusion = latent_energy.shape[0] > 0
    for p in prange(pieces):
        M = H = L = np.float64(0)
        for a in range(p * served // pieces, (p + 1) * served // pieces):
            i = np.uint64(birth_index[a])
            m = np.float64(mass[i])
            M += m
            H += m * (c_p * np.float64(temperature[i]) + np.float64(latent_store[i]))
            L += np.float64(latent_energy[i]) if fusion else np.float64(0)
        boiled_sums[0, p], boiled_sums[1, p], boiled_sums[2, p] = M, H, L


@cpu_stage
def spawn_bubbles(
    birth_index, free_index, boiling, bubbles, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, latent_store,
    bubble_volume, bubble_radius, birth_height, age, cargo, birth_excess,
):
    """See `melt.reference.bubble_birth.spawn_bubbles`."""
    real = type(bubbles.spacing)
    wide = position.dtype.type
    pieces = birth_excess.shape[0]
    for p in prange(pieces):
        total = 0.0
        for a in range(p * served // pieces, (p + 1) * served // pieces):
            i = np.uint64(birth_index[a])
            total += boil_excess(np.float64(mass[i]), np.float64(temperature[i]), np.float64(latent_store[i]), boiling)
        birth_excess[p] = total
    stays = boiling.mass_model == MASS_NUCLEATE
    r = bubbles.birth_radius
    volume = sphere_volume(np.float64(r))
    for a in prange(served):
        i = np.uint64(birth_index[a])
        for k in range(4):
            j = np.uint64(free_index[4 * a + k])
            own = np.int32(first_id + 4 * a + k)
            dx, dy, dz = ball_offset(own, step_low, step_high, boiling.seed_low, boiling.seed_high, 0, r)
            x = position[0, i] + wide(bubbles.birth_reach * dx)
            y = position[1, i] + wide(bubbles.birth_reach * dy)
            z = position[2, i] + wide(bubbles.birth_reach * dz)
            z = inside(z, wide(bubbles.lower_z), wide(bubbles.upper_z), wide(r))
            phase[j] = BUBBLE
            id[j] = own
            position[0, j] = inside(x, wide(bubbles.lower_x), wide(bubbles.upper_x), wide(r))
            position[1, j] = inside(y, wide(bubbles.lower_y), wide(bubbles.upper_y), wide(r))
            position[2, j] = z
            for c in range(3):
                velocity[c, j] = velocity[c, i]
            mass[j] = latent_store[j] = age[j] = real(0)
            temperature[j] = boiling.boiling_point
            bubble_volume[j] = volume
            bubble_radius[j] = r
            rest_volume[j] = min(real(volume), bubbles.most_volume)
            birth_height[j] = real(z - wide(bubbles.floor))
            cargo[j] = 0 if stays else 1
        if stays:
            latent_store[i] = real(0)
            temperature[i] -= boiling.subcooling
        else:
            phase[i] = INACTIVE
            mass[i] = rest_volume[i] = real(0)
