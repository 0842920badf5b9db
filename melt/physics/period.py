"""Distances in a periodic box. Slime spec 1."""

import math

from melt._compile import scalar


@scalar
def wrap(d, length, inverse):
    """Return a difference along one axis taken to its nearest image; unchanged where length and inverse are 0."""
    return d - length * type(d)(math.floor(d * inverse + type(d)(0.5)))
