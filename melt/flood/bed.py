"""Bed elevation on the host, as the stages sample it."""

from types import SimpleNamespace

import numpy as np

from melt.params_flood import SAMPLER_BICUBIC, SAMPLER_BILINEAR, SAMPLER_BSPLINE
from melt.reference.flood_bed import bed

_SAMPLERS = {"bspline": SAMPLER_BSPLINE, "bilinear": SAMPLER_BILINEAR, "bicubic": SAMPLER_BICUBIC}


def bed_at(terrain, x, y, sampler="bspline"):
    """Return the elevation [m] above the datum at local places x, y (arrays of one shape)."""
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    n = x.size
    grid = SimpleNamespace(
        origin_x=terrain.lower[0], origin_y=terrain.lower[1], inverse_dx=1 / terrain.cell[0], inverse_dy=1 / terrain.cell[1],
        nx=terrain.shape[1], ny=terrain.shape[0], sampler=_SAMPLERS[sampler],
    )
    found, slope = np.zeros(n), np.zeros((2, n))
    position = np.stack([x.ravel(), y.ravel(), np.zeros(n)])
    bed(position, np.zeros(n, np.int32), terrain.elevation.ravel(), grid, found, slope)
    return found.reshape(x.shape)
