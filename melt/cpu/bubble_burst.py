"""CPU twin of `melt.reference.bubble_burst`."""

import math

import numpy as np

from melt._compile import cpu_serial, cpu_stage, prange
from melt.physics.bubble_life import column_of, height_steps, steps_height
from melt.physics.phases import INACTIVE, LIQUID, SOLID
from melt.physics.search import squared_distance


@cpu_serial
def surface_column(position, phase, grid, bubbles, surface_column):
    """See `melt.reference.bubble_burst.surface_column`."""
    for c in range(surface_column.shape[0]):
        surface_column[c] = -1
    for i in range(phase.shape[0]):
        if phase[i] <= SOLID:
            c = column_of(position[0, i], position[1, i], grid)
            surface_column[c] = max(surface_column[c], height_steps(position[2, i], bubbles.floor, bubbles.spacing))


@cpu_stage
def burst_test(
    position, bubble_radius, bubble_index, bubble_count, surface_column, grid, bubbles, height, bubble_fate, burst_top
):
    """See `melt.reference.bubble_burst.burst_test`."""
    real = type(bubbles.spacing)
    wide = position.dtype.type
    for i in prange(bubble_fate.shape[0]):
        bubble_fate[i] = 0
        burst_top[i] = real(0)
    for a in prange(bubble_count[0]):
        i = np.uint64(bubble_index[a])
        r = bubble_radius[i]
        if r > real(0):
            z = real(position[2, i] - wide(bubbles.floor))
            steps = surface_column[np.uint64(column_of(position[0, i], position[1, i], grid))]
            top = min(steps_height(steps, bubbles.spacing) if steps >= 0 else z, height)
            burst_top[i] = bubbles.floor + top
            if z + r >= top:
                bubble_fate[i] = 1 if r <= bubbles.burst_radius else 2


@cpu_stage
def burst_push(position, phase, burst_index, burst_count, burst_top, bubbles, velocity):
    """See `melt.reference.bubble_burst.burst_push`: a liquid particle gathers the bursts in the order of the list."""
    real = type(bubbles.spacing)
    wide = position.dtype.type
    reach = bubbles.push_reach
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            continue
        u = v = w = real(0)
        for a in range(np.uint64(burst_count[0])):
            b = np.uint64(burst_index[a])
            dx = real(position[0, i] - position[0, b])
            dy = real(position[1, i] - position[1, b])
            dz = real(position[2, i] - wide(burst_top[b]))
            d2 = squared_distance(dx, dy, dz)
            if d2 < reach * reach:
                share = real(1) if bubbles.push_even == 1 else real(1) - math.sqrt(d2) / reach
                u += bubbles.push_side * dx * share
                v += bubbles.push_side * dy * share
                w += bubbles.push_up * abs(dz) * share
        velocity[0, i] += u
        velocity[1, i] += v
        velocity[2, i] += w


@cpu_stage
def remove_bubbles(bubble_index, bubble_count, bubble_fate, cargo, phase, released):
    """See `melt.reference.bubble_burst.remove_bubbles`."""
    count, pieces = int(bubble_count[0]), released.shape[1]
    for p in prange(pieces):
        vanished = burst = carried = 0
        for a in range(p * count // pieces, (p + 1) * count // pieces):
            i = np.uint64(bubble_index[a])
            fate = bubble_fate[i]
            if fate > 0:
                vanished += 1 if fate == 1 else 0
                burst += 1 if fate == 2 else 0
                carried += cargo[i]
                phase[i] = INACTIVE
        released[0, p], released[1, p], released[2, p] = vanished, burst, carried
