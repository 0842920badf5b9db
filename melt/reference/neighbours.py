r"""Neighbour lists: all j with :math:`r_{ij} < h`, all pairs tried. Melting spec 2.9."""

from melt.reference._near import write_near


def neighbours_grid(
    position, phase, cell_start, grid, smoothing, neighbour_count, neighbour_index,
):
    """Write the neighbours of all but walls, ascending, without the particle itself.

    Neighbours have any phase but inactive; a particle at the support h exactly is none, one
    at the same place is one. The list of any other particle is empty. Entries beyond the
    count are left as they were.

    Reads: position (3, n) [m] in cell order, phase (n,); the cells are not used (all pairs).
    Writes: neighbour_count (n,), the true number even where it exceeds the capacity;
        neighbour_index (n, capacity), then only the first ones.
    """
    write_near(position, phase, smoothing, neighbour_count, neighbour_index)
