"""CUDA twin of `melt.reference.bubble_birth`."""

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.params import MASS_NUCLEATE
from melt.physics.bubble_life import boil_excess
from melt.physics.bubbles import inside, sphere_volume
from melt.physics.phases import BUBBLE, INACTIVE, LIQUID
from melt.physics.philox import ball_offset, random_words


@cuda_kernel
def _boil_candidates(id, phase, temperature, latent_store, boiling, step_low, step_high, candidate):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    boils = 0
    if phase[i] == LIQUID and temperature[i] >= boiling.boiling_point and latent_store[i] >= boiling.latent_heat:
        word, _, _, _ = random_words(id[i], step_low, step_high, 0, boiling.seed_low, boiling.seed_high, 1)
        boils = 1 if np.int64(word >> np.uint64(2)) < boiling.threshold else 0
    candidate[i] = boils


def boil_candidates(id, phase, temperature, latent_store, boiling, step_low, step_high, candidate):
    """See `melt.reference.bubble_birth.boil_candidates`."""
    _boil_candidates.launch(
        phase.shape[0], id, phase, temperature, latent_store, boiling, step_low, step_high, candidate
    )


@cuda_kernel
def _boiled_sums(birth_index, mass, temperature, latent_store, latent_energy, boiling, served, boiled_sums):
    p = cuda.grid(1)
    pieces = boiled_sums.shape[1]
    if p >= pieces:
        return
    c_p = np.float64(boiling.specific_heat)
    fusion = latent_energy.shape[0] > 0
    M = H = L = np.float64(0)
    for a in range(p * served // pieces, (p + 1) * served // pieces):
        i = birth_index[a]
        m = np.float64(mass[i])
        M += m
        H += m * (c_p * np.float64(temperature[i]) + np.float64(latent_store[i]))
        L += np.float64(latent_energy[i]) if fusion else np.float64(0)
    boiled_sums[0, p], boiled_sums[1, p], boiled_sums[2, p] = M, H, L


def boiled_sums(birth_index, mass, temperature, latent_store, latent_energy, boiling, served, boiled_sums):
    """See `melt.reference.bubble_birth.boiled_sums`."""
    _boiled_sums.launch(
        boiled_sums.shape[1], birth_index, mass, temperature, latent_store, latent_energy, boiling, served, boiled_sums
    )


@cuda_kernel
def _birth_excess(birth_index, boiling, served, mass, temperature, latent_store, birth_excess):
    p = cuda.grid(1)
    pieces = birth_excess.shape[0]
    if p >= pieces:
        return
    total = np.float64(0)
    for a in range(p * served // pieces, (p + 1) * served // pieces):
        i = birth_index[a]
        total += boil_excess(np.float64(mass[i]), np.float64(temperature[i]), np.float64(latent_store[i]), boiling)
    birth_excess[p] = total


@cuda_kernel
def _spawn_bubbles(
    birth_index, free_index, boiling, bubbles, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, latent_store,
    bubble_volume, bubble_radius, birth_height, age, cargo,
):
    a = cuda.grid(1)
    if a >= served:
        return
    real = type(bubbles.spacing)
    wide = position.dtype.type
    stays = boiling.mass_model == MASS_NUCLEATE
    r = bubbles.birth_radius
    volume = sphere_volume(np.float64(r))
    i = birth_index[a]
    for k in range(4):
        j = free_index[4 * a + k]
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


def spawn_bubbles(
    birth_index, free_index, boiling, bubbles, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, latent_store,
    bubble_volume, bubble_radius, birth_height, age, cargo, birth_excess,
):
    """See `melt.reference.bubble_birth.spawn_bubbles`."""
    _birth_excess.launch(
        birth_excess.shape[0], birth_index, boiling, served, mass, temperature, latent_store, birth_excess
    )
    _spawn_bubbles.launch(
        int(served), birth_index, free_index, boiling, bubbles, step_low, step_high, first_id, served,
        phase, id, position, velocity, mass, rest_volume, temperature, latent_store,
        bubble_volume, bubble_radius, birth_height, age, cargo,
    )
