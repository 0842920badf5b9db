"""CPU twin of `melt.reference.condense`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.bubble_life import column_of, steps_height
from melt.physics.phases import LIQUID
from melt.physics.philox import random_words, unit_share


@cpu_stage
def condense(
    surface_column, free_index, grid, bubbles, boiling, pbf, condensate, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, latent_store, bubble_radius, age, cargo,
    effect_precision, support_radius, iterations,
):
    """See `melt.reference.condense.condense`."""
    d = bubbles.spacing
    real = type(d)
    wide = position.dtype.type
    for a in prange(served):
        i = np.uint64(free_index[a])
        own = np.int32(first_id + a)
        first, second, _, _ = random_words(own, step_low, step_high, 0, boiling.seed_low, boiling.seed_high, 2)
        position[0, i] = wide(condensate.lower_x) + wide(condensate.width_x * unit_share(first, d))
        position[1, i] = wide(condensate.lower_y) + wide(condensate.width_y * unit_share(second, d))
        steps = surface_column[np.uint64(column_of(position[0, i], position[1, i], grid))]
        top = steps_height(steps, d) if steps >= 0 else real(-0.5) * d
        position[2, i] = wide(bubbles.floor) + wide(top + d)
        phase[i], id[i] = LIQUID, own
        velocity[0, i] = velocity[1, i] = velocity[2, i] = real(0)
        mass[i], rest_volume[i], temperature[i] = condensate.mass, condensate.volume, condensate.temperature
        latent_store[i] = bubble_radius[i] = age[i] = real(0)
        cargo[i] = 0
        if pbf.uniform == 0 or pbf.same_iterations == 0:
            effect_precision[i], support_radius[i], iterations[i] = real(1), pbf.support, pbf.iterations
