"""Columns of the neighbour grid, in which the height of the surface is kept."""

import numpy as np

STEPS = 4096  # of the surface height, per spacing


def column(position, grid):
    """Column of the neighbour grid over each particle, a bin like its cells (see `melt.reference.grid`)."""
    real = position.dtype.type
    c = []
    with np.errstate(invalid="ignore", over="ignore"):
        for a, origin, count in ((0, grid.origin_x, grid.nx), (1, grid.origin_y, grid.ny)):
            t = (position[a] - real(origin)) * real(grid.inverse_cell)
            c.append(np.where(t > 0, np.minimum(t, count - 1), 0).astype(np.int64))
    return c[0] + int(grid.nx) * c[1]
