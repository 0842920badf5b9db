"""Effect precision of one particle. Boiling eq (15), spec 2.6."""

import math

import numpy as np

from melt._compile import scalar


@scalar
def target_precision(y, height, momentum, largest, pbf):
    """Return F of a particle y above the floor: 1 at the surface, below it by height and share of momentum."""
    real = type(y)
    if y >= height:
        return real(1)
    share = momentum / largest if largest > real(0) else real(0)
    a = pbf.height_share
    return a * (max(y, real(0)) / height) + (real(1) - a) * share


@scalar
def iterations_of(F, pbf):
    """Return J of a particle, int32."""
    wanted = np.int32(math.ceil(F * type(F)(pbf.iterations)))
    return min(max(wanted, pbf.minimum_iterations), pbf.iterations)
