"""Condensate: liquid that left as vapour and returns to the surface. Boiling spec 3 (mass_model = recycle)."""

from melt.reference._column import STEPS, column
from melt.reference._philox import random_words


def condense(
    surface_column, free_index, grid, bubbles, boiling, pbf, condensate, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, latent_store, bubble_radius, age, cargo,
    effect_precision, support_radius, iterations,
):
    """Turn the first ``served`` free slots into liquid that lies on the surface, at rest, at the air's temperature.

    Number a enters at a random place (stream 2 by its id) of the tank's box, a spacing above the highest particle
    there: half of it to the surface, half to its own centre. A column without liquid is filled from the floor.

    Reads: surface_column (nx ny,), free_index (n,).
    Writes: of those slots phase, id, position (3, n) [m], velocity (3, n) [m/s], mass [kg], rest_volume [m^3],
        temperature [degC], latent_store [J/kg], the fields of bubbles as 0, and with effect precision that of a
        particle at the surface, all of the support [m] and all iterations; others keep theirs.
    """
    d = float(bubbles.spacing)
    for a in range(int(served)):
        i, own = free_index[a], int(first_id) + a
        words = random_words(own, step_low, step_high, 0, boiling.seed_low, boiling.seed_high, 2)
        u, v = ((w >> 8) / 2**24 for w in words[:2])
        position[0, i] = float(condensate.lower_x) + float(condensate.width_x) * u
        position[1, i] = float(condensate.lower_y) + float(condensate.width_y) * v
        steps = surface_column[column(position[:, i : i + 1], grid)[0]]
        top = steps * d / STEPS if steps >= 0 else -d / 2
        position[2, i] = float(bubbles.floor) + top + d
        phase[i], id[i], velocity[:, i] = 0, own, 0
        mass[i], rest_volume[i], temperature[i] = condensate.mass, condensate.volume, condensate.temperature
        latent_store[i], bubble_radius[i], age[i], cargo[i] = 0, 0, 0, 0
        if pbf.uniform == 0 or pbf.same_iterations == 0:
            effect_precision[i], support_radius[i], iterations[i] = 1, pbf.support, pbf.iterations
