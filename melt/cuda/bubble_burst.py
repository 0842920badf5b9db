"""CUDA twin of `melt.reference.bubble_burst`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.bubble_life import column_of, height_steps, steps_height
from melt.physics.phases import INACTIVE, LIQUID, SOLID
from melt.physics.search import squared_distance


@cuda_kernel
def _no_surface(surface_column):
    c = cuda.grid(1)
    if c < surface_column.shape[0]:
        surface_column[c] = -1


@cuda_kernel
def _surface_column(position, phase, grid, bubbles, surface_column):
    i = cuda.grid(1)
    if i < phase.shape[0] and phase[i] <= SOLID:
        c = column_of(position[0, i], position[1, i], grid)
        # integers: any order gives the same
        cuda.atomic.max(surface_column, c, height_steps(position[2, i], bubbles.floor, bubbles.spacing))


def surface_column(position, phase, grid, bubbles, surface_column):
    """See `melt.reference.bubble_burst.surface_column`."""
    _no_surface.launch(surface_column.shape[0], surface_column)
    _surface_column.launch(phase.shape[0], position, phase, grid, bubbles, surface_column)


@cuda_kernel
def _no_fate(bubble_fate, burst_top):
    i = cuda.grid(1)
    if i < bubble_fate.shape[0]:
        bubble_fate[i] = 0
        burst_top[i] = burst_top.dtype.type(0)


@cuda_kernel
def _burst_test(
    position, bubble_radius, bubble_index, bubble_count, surface_column, grid, bubbles, height, bubble_fate, burst_top
):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    real = type(bubbles.spacing)
    wide = position.dtype.type
    i = bubble_index[a]
    r = bubble_radius[i]
    if r > real(0):
        z = real(position[2, i] - wide(bubbles.floor))
        steps = surface_column[column_of(position[0, i], position[1, i], grid)]
        top = min(steps_height(steps, bubbles.spacing) if steps >= 0 else z, height)
        burst_top[i] = bubbles.floor + top
        if z + r >= top:
            bubble_fate[i] = 1 if r <= bubbles.burst_radius else 2


def burst_test(
    position, bubble_radius, bubble_index, bubble_count, surface_column, grid, bubbles, height, bubble_fate, burst_top
):
    """See `melt.reference.bubble_burst.burst_test`."""
    n = bubble_fate.shape[0]
    _no_fate.launch(n, bubble_fate, burst_top)
    _burst_test.launch(
        n, position, bubble_radius, bubble_index, bubble_count, surface_column, grid, bubbles, height, bubble_fate,
        burst_top,
    )


@cuda_kernel
def _burst_push(position, phase, burst_index, burst_count, burst_top, bubbles, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0] or phase[i] != LIQUID:
        return
    real = type(bubbles.spacing)
    wide = position.dtype.type
    reach = bubbles.push_reach
    u = v = w = real(0)
    for a in range(burst_count[0]):
        b = burst_index[a]
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


def burst_push(position, phase, burst_index, burst_count, burst_top, bubbles, velocity):
    """See `melt.reference.bubble_burst.burst_push`."""
    _burst_push.launch(phase.shape[0], position, phase, burst_index, burst_count, burst_top, bubbles, velocity)


@cuda_kernel
def _remove_bubbles(bubble_index, bubble_count, bubble_fate, cargo, phase, released):
    # a piece of the list per thread: a bubble is in one piece, and its phase has one writer
    p = cuda.grid(1)
    count, pieces = int(bubble_count[0]), released.shape[1]
    if p >= pieces:
        return
    vanished = burst = carried = 0
    for a in range(p * count // pieces, (p + 1) * count // pieces):
        i = bubble_index[a]
        fate = bubble_fate[i]
        if fate > 0:
            vanished += 1 if fate == 1 else 0
            burst += 1 if fate == 2 else 0
            carried += cargo[i]
            phase[i] = INACTIVE
    released[0, p], released[1, p], released[2, p] = vanished, burst, carried


def remove_bubbles(bubble_index, bubble_count, bubble_fate, cargo, phase, released):
    """See `melt.reference.bubble_burst.remove_bubbles`."""
    _remove_bubbles.launch(released.shape[1], bubble_index, bubble_count, bubble_fate, cargo, phase, released)
