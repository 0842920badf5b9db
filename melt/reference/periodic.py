"""Neighbour lists in a periodic box: all j with r_ij < h to the nearest image, all pairs tried. Slime spec S2."""

import numpy as np

from melt.reference._period import nearest


def neighbours_periodic(
    position, phase, cell_start, grid, smoothing, period, neighbour_count, neighbour_index,
):
    """Write the neighbours of all but walls, ascending, without the particle itself, as `neighbours_grid` does.

    Of the images of a particle only the nearest counts: a periodic axis has to be longer than 2 h for there to
    be no other. Positions are in the box along periodic axes, whose cells begin where the box does.
    Reads: position (3, n) [m] in cell order, phase (n,); the cells are not used (all pairs).
    Writes: neighbour_count (n,), the true number even where it exceeds the capacity;
        neighbour_index (n, capacity), then only the first ones.
    """
    x, h = position.astype(np.float64), float(smoothing.support)
    for i in range(phase.shape[0]):
        near = np.empty(0, dtype=np.intp)
        if phase[i] not in (2, 5):
            with np.errstate(invalid="ignore", over="ignore"):
                x_ij = nearest(x[:, i, None] - x, period)
                near = np.flatnonzero(((x_ij**2).sum(axis=0) < h**2) & (phase != 5))
            near = near[near != i]
        neighbour_count[i] = near.size
        stored = min(near.size, neighbour_index.shape[1])
        neighbour_index[i, :stored] = near[:stored]
