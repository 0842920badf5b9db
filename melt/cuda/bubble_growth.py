"""CUDA twin of `melt.reference.bubble_growth`."""

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.physics.bubbles import grown_radius, radius_of, sphere_volume
from melt.physics.phases import BUBBLE


@cuda_kernel
def _bubble_growth(
    position, bubble_index, bubble_count, bubble_volume, birth_height, bubbles, dt, age, bubble_radius, rest_volume,
):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    real = type(bubbles.spacing)
    wide = position.dtype.type
    b = bubble_index[a]
    start = real(radius_of(bubble_volume[b]))
    y = real(position[2, b] - wide(bubbles.floor))
    age[b] += dt
    r = grown_radius(start, y, birth_height[b], age[b], bubbles)
    bubble_radius[b] = r
    rest_volume[b] = min(sphere_volume(r), bubbles.most_volume)


def bubble_growth(
    position, bubble_index, bubble_count, bubble_volume, birth_height, bubbles, dt, age, bubble_radius, rest_volume,
):
    """See `melt.reference.bubble_growth.bubble_growth`."""
    _bubble_growth.launch(
        bubble_index.shape[0], position, bubble_index, bubble_count, bubble_volume, birth_height, bubbles,
        dt, age, bubble_radius, rest_volume,
    )


@cuda_kernel
def _largest_bubble(phase, bubble_radius, largest_bubble):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], largest_bubble.shape[0]
    if p >= pieces:
        return
    real = bubble_radius.dtype.type
    largest = real(0)
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        if phase[i] == BUBBLE:
            r = bubble_radius[i]
            # a NaN would lose every comparison that follows; infinity wins them
            largest = max(largest, r if r == r else real(np.inf))
    largest_bubble[p] = largest


def largest_bubble(phase, bubble_radius, largest_bubble):
    """See `melt.reference.bubble_growth.largest_bubble`."""
    _largest_bubble.launch(largest_bubble.shape[0], phase, bubble_radius, largest_bubble)
