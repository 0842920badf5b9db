r"""Bed under each column, its slope and curvature: value and exact derivatives of one function. Flood spec 2, E5.

``bspline2``: with the nearest node k and u in [-1/2, 1/2] from it, the weights of k-1, k, k+1 along each axis are
:math:`\tfrac12(\tfrac12-u)^2,\ \tfrac34-u^2,\ \tfrac12(\tfrac12+u)^2`. ``bilinear``: linear in each patch.
``bicubic``: Catmull-Rom. Numbers of nodes are clamped at the edges of the grid.
"""

import numpy as np

from melt.reference._flood import sample


def bed(position, phase, terrain, terrain_grid, bed, bed_slope):
    """Write b and its gradient under columns of water and falling ones; 0 for others.

    Reads: position (3, n) [m], phase (n,), terrain (ny nx,) [m].
    Writes: bed (n,) [m], bed_slope (2, n).
    """
    b, b_x, b_y, *_ = sample(position, terrain, terrain_grid, terrain_grid.sampler)
    here = phase != 5
    bed[:] = np.where(here, b, 0.0)
    bed_slope[:] = np.where(here, [b_x, b_y], 0.0)


def bed_curvature(position, phase, terrain, terrain_grid, bed_curvature):
    """Write the second derivatives xx, yy, xy of the bed under columns; 0 for others.

    Reads: position (3, n) [m], phase (n,), terrain (ny nx,) [m].
    Writes: bed_curvature (3, n) [1/m].
    """
    second = sample(position, terrain, terrain_grid, terrain_grid.sampler)[3:]
    bed_curvature[:] = np.where(phase != 5, second, 0.0)
