r"""Neighbour lists: all j with :math:`r_{ij} < h`, all pairs tried. Melting spec 2.9."""

import numpy as np


def neighbours_grid(
    position, phase, cell_start, grid, smoothing, neighbour_count, neighbour_index,
):
    """Write the neighbours of liquid and solid particles, ascending, without the particle itself.

    Neighbours have any phase but inactive; a particle at the support h exactly is none, one
    at the same place is one. The list of any other particle is empty. Entries beyond the
    count are left as they were.

    Reads: position (3, n) [m] in cell order, phase (n,); the cells are not used (all pairs).
    Writes: neighbour_count (n,), the true number even where it exceeds the capacity;
        neighbour_index (n, capacity), then only the first ones.
    """
    x = position.astype(np.float64)
    h = float(smoothing.support)
    for i in range(phase.shape[0]):
        near = np.empty(0, dtype=np.intp)
        if phase[i] in (0, 1):
            x_ij = x[:, i, None] - x
            near = np.flatnonzero(((x_ij**2).sum(axis=0) < h**2) & (phase != 5))
            near = near[near != i]
        neighbour_count[i] = near.size
        stored = min(near.size, neighbour_index.shape[1])
        neighbour_index[i, :stored] = near[:stored]
