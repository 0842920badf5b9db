"""CPU twin of `melt.reference.bubble_growth`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.bubbles import grown_radius, radius_of, sphere_volume
from melt.physics.phases import BUBBLE


@cpu_stage
def bubble_growth(
    position, bubble_index, bubble_count, bubble_volume, birth_height, bubbles, dt, age, bubble_radius, rest_volume,
):
    """See `melt.reference.bubble_growth.bubble_growth`."""
    real = type(bubbles.spacing)
    wide = position.dtype.type
    for a in prange(bubble_count[0]):
        b = np.uint64(bubble_index[a])
        start = real(radius_of(bubble_volume[b]))
        y = real(position[2, b] - wide(bubbles.floor))
        age[b] += dt
        r = grown_radius(start, y, birth_height[b], age[b], bubbles)
        bubble_radius[b] = r
        rest_volume[b] = min(sphere_volume(r), bubbles.most_volume)


@cpu_stage
def largest_bubble(phase, bubble_radius, largest_bubble):
    """See `melt.reference.bubble_growth.largest_bubble`."""
    real = bubble_radius.dtype.type
    n, pieces = phase.shape[0], largest_bubble.shape[0]
    for p in prange(pieces):
        largest = real(0)
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            if phase[i] == BUBBLE:
                r = bubble_radius[i]
                # a NaN would lose every comparison that follows; infinity wins them
                largest = max(largest, r if r == r else real(np.inf))
        largest_bubble[p] = largest
