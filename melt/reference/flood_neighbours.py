r"""Neighbours of columns whose supports differ: all j with :math:`r_{ij} < g \max(h_i, h_j)`, all pairs tried.

The factor g (``growth``) is what a support may grow by before the lists are made again. Flood spec 1.
"""

import numpy as np

from melt.reference._flood import apart


def _reach(support_radius, flood):
    return np.nan_to_num(float(flood.growth) * support_radius.astype(np.float64), nan=0.0)


def _write(near, count, index):
    for i, row in enumerate(near):
        found = np.flatnonzero(row)
        count[i] = found.size
        stored = min(found.size, index.shape[1])
        index[i, :stored] = found[:stored]


def flood_neighbours(position, phase, support_radius, cell_start, cell_reach, grid, flood, neighbour_count, neighbour_index):
    """Write the neighbours of columns of water and of falling ones, ascending: columns of water, not itself.

    A pair exactly at the distance g h is none; two at one place are. The height does not count. Entries beyond
    the count are left as they were.

    Reads: position (3, n) [m] in cell order, phase (n,), support_radius (n,) [m]; cells are not used.
    Writes: neighbour_count (n,), the true number even where it exceeds the capacity; neighbour_index
        (n, capacity), then only the first ones.
    """
    g = _reach(support_radius, flood)
    r = apart(position, position)
    near = (r**2 < np.maximum(g[:, None], g[None, :]) ** 2) & (phase == 0)[None, :]
    near &= ((phase == 0) | (phase == 6))[:, None]
    np.fill_diagonal(near, False)
    _write(near, neighbour_count, neighbour_index)


def wall_neighbours(
    position, phase, support_radius, boundary_position, boundary_start, boundary_ring, grid, flood, wall_count, wall_index
):
    """Write the boundary particles closer to a column of water than g h_i, ascending; nothing in a scene without walls. E14.

    Reads: position (3, n) [m], phase (n,), support_radius (n,) [m], boundary_position (3, b) [m]; cells are not used.
    Writes: wall_count and wall_index as `flood_neighbours`.
    """
    if wall_count.shape[0] == 0:
        return
    near = apart(position, boundary_position) ** 2 < _reach(support_radius, flood)[:, None] ** 2
    _write(near & (phase == 0)[:, None], wall_count, wall_index)
