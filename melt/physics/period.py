"""Scalar formulas of periodic axes. Slime spec 1; an axis of length 0 is not periodic."""

import math

from melt._compile import scalar


@scalar
def wrap(d, length, inverse):
    """Return the distance d along an axis to the nearest image; inverse = 1/length. Both 0: d itself.

    Adding 3/2 of the number from which on a float has no fraction, and taking it off again, rounds to
    the nearest integer, ties to even: -d gives minus the result. math.floor makes an integer, which
    doubles the cost of a loop over pairs (measured: 3.9 against 1.8 ms for 1.5 million pairs).
    """
    wide = type(d)
    single = wide(1) + wide(1e-10) == wide(1)
    big = wide(12582912.0) if single else wide(6755399441055744.0)
    images = (d * wide(inverse) + big) - big
    return d - wide(length) * images


@scalar
def missed(start, step, arrival, length, inverse):
    """Return start + step - arrival along an axis to the nearest image, with the difference of the large numbers first."""
    return wrap((start - arrival) + step, length, inverse)


@scalar
def into_box(x, lower, length, inverse):
    """Return coordinate x moved by whole lengths into [lower, lower + length); x itself for length 0."""
    wide = type(x)
    start, edge = wide(lower), wide(length)
    if not edge > wide(0):
        return x
    moved = x - edge * wide(math.floor((x - start) * wide(inverse)))
    # rounding: just below the start is the start of the next image, and the product may be off by one
    if moved >= start + edge:
        return max(moved - edge, start)
    return start if moved < start else moved


@scalar
def near_cell(cell, k, count, length):
    """Return the k-th (0, 1, 2), in ascending order, of the distinct cells at a cell along one axis; -1: there is none."""
    if count <= 3 and length > 0:
        return k if k < count else -1
    if length > 0 and cell == 0 and k == 2:
        return count - 1
    if length > 0 and cell == 0:
        return k
    if length > 0 and cell == count - 1:
        return count - 3 + k if k > 0 else 0
    near = cell - 1 + k
    return near if 0 <= near < count else -1
