"""Vaporisation: liquid particles that boil, and the four bubbles that each turns into. Boiling spec 3."""

import numpy as np

from melt.reference._philox import ball_offset, random_words

NUCLEATE = 1


def boil_candidates(id, phase, temperature, latent_store, boiling, step_low, step_high, candidate):
    """Write 1 for liquid at the boiling point whose store holds the latent heat and whose draw succeeds, else 0.

    The draw succeeds where 30 random bits are below the threshold; 2^30 is always above.

    Reads: id, phase (n,), temperature (n,) [degC], latent_store (n,) [J/kg]; the step's number in two words.
    Writes: candidate (n,).
    """
    candidate[:] = 0
    ready = (phase == 0) & (temperature >= boiling.boiling_point) & (latent_store >= boiling.latent_heat)
    for i in np.flatnonzero(ready):
        word = random_words(id[i], step_low, step_high, 0, boiling.seed_low, boiling.seed_high, 1)[0]
        candidate[i] = word >> 2 < int(boiling.threshold)


def boiled_sums(birth_index, mass, temperature, latent_store, latent_energy, boiling, served, boiled_sums):
    """Write what the first ``served`` particles of the list take along: mass, m (c_p T + store), heat of fusion.

    Where liquid comes from solids, their masses differ and they keep the heat that melted them.

    Reads: birth_index (n,), mass (n,) [kg], temperature (n,) [degC], latent_store (n,) [J/kg], latent_energy (n,) [J]
        (where melting has a latent heat only). Writes: boiled_sums (3, 64) [kg, J, J].
    """
    served, pieces = int(served), boiled_sums.shape[1]
    on = birth_index[:served]
    m, T, store = (a[on].astype(np.float64) for a in (mass, temperature, latent_store))
    fusion = latent_energy[on].astype(np.float64) if latent_energy.shape[0] else np.zeros(served)
    for p in range(pieces):
        part = slice(p * served // pieces, (p + 1) * served // pieces)
        for row, values in enumerate((m, m * (float(boiling.specific_heat) * T + store), fusion)):
            boiled_sums[row, p] = values[part].sum()


def _confined(x, radius, bubbles):
    sides = [(bubbles.lower_x, bubbles.upper_x), (bubbles.lower_y, bubbles.upper_y), (bubbles.lower_z, bubbles.upper_z)]
    low, high = np.array(sides, dtype=np.float64).T
    return np.where(2 * radius > high - low, (low + high) / 2, np.clip(x, low + radius, high - radius))


def spawn_bubbles(
    birth_index, free_index, boiling, bubbles, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, latent_store,
    bubble_volume, bubble_radius, birth_height, age, cargo, birth_excess,
):
    """Turn each of the first ``served`` particles of the list into four bubbles; those of rank a take free slots 4a to 4a+3.

    A bubble stands at a random place within R_s of its parent, within the walls, and has the parent's velocity; it
    carries a quarter of its parent as cargo. The parent's slot is free in the next step. With ``nucleate`` the
    parent stays, cools down and loses its latent store, and its bubbles carry nothing.

    Reads: birth_index (n,) by ascending id, free_index (n,).
    Writes: the fields of bubbles and parents, positions [m], velocity [m/s], mass [kg], volumes [m^3], temperature
        [degC], latent_store [J/kg], birth_height [m], age [s]; birth_excess (64,) [J], heat above the latent heat.
    """
    served, stays = int(served), boiling.mass_model == NUCLEATE
    radius, reach = float(bubbles.birth_radius), float(bubbles.birth_reach)
    point, latent, c_p = float(boiling.boiling_point), float(boiling.latent_heat), float(boiling.specific_heat)
    volume = 4 / 3 * np.pi * radius**3
    excess = np.zeros(served)
    for a in range(served):
        i = birth_index[a]
        m, T, store = float(mass[i]), float(temperature[i]), float(latent_store[i])
        excess[a] = m * (store + c_p * float(boiling.subcooling) if stays else store - latent + c_p * (T - point))
        for k in range(4):
            j, own = free_index[4 * a + k], int(first_id) + 4 * a + k
            offset = ball_offset(own, step_low, step_high, boiling.seed_low, boiling.seed_high, 0)
            x = _confined(position[:, i].astype(np.float64) + reach * np.array(offset), radius, bubbles)
            phase[j], id[j] = 3, own
            position[:, j], velocity[:, j] = x, velocity[:, i]
            mass[j], temperature[j], latent_store[j] = 0, point, 0
            bubble_volume[j], bubble_radius[j] = volume, radius
            rest_volume[j] = min(volume, float(bubbles.most_volume))
            birth_height[j], age[j], cargo[j] = x[2] - float(bubbles.floor), 0, 0 if stays else 1
        if stays:
            latent_store[i], temperature[i] = 0, T - float(boiling.subcooling)
        else:
            phase[i], mass[i], rest_volume[i] = 5, 0, 0
    pieces = birth_excess.shape[0]
    for p in range(pieces):
        birth_excess[p] = excess[p * served // pieces : (p + 1) * served // pieces].sum()
