"""Distances in a periodic box. Slime spec 1."""

import math

from melt._compile import scalar


@scalar
def wrap(d, length, inverse):
    """Return a difference of coordinates taken to the nearest image [m]; ``inverse`` 0: the axis is not periodic."""
    wide = type(d)
    return d - wide(length) * wide(math.floor(d * wide(inverse) + wide(0.5)))
