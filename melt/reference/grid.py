"""Cells of the neighbour grid, stable sort by cell, reordering. Melting spec 2.9."""

import numpy as np


def cell_index(position, phase, grid, cell):
    """Write the linear cell (x fastest) of each particle; inactive ones get the last number.

    The cell is a bin, defined in the precision of the positions (a float64 formula would put
    lattice points on cell faces elsewhere). Positions outside are clamped; NaN counts as cell 0.

    Reads: position (3, n) [m], phase (n,).
    Writes: cell (n,), from 0 to nx ny nz.
    """
    real = position.dtype.type
    origin = grid.origin_x, grid.origin_y, grid.origin_z
    count = grid.nx, grid.ny, grid.nz
    c = []
    with np.errstate(invalid="ignore", over="ignore"):
        for a in range(3):
            t = (position[a] - real(origin[a])) * real(grid.inverse_cell)
            c.append(np.where(t > 0, np.minimum(t, count[a] - 1), 0).astype(np.int64))
    linear = c[0] + count[0] * (c[1] + count[1] * c[2])
    cell[:] = np.where(phase == 5, int(count[0]) * int(count[1]) * int(count[2]), linear)


def cell_sort(cell, order, cell_start, arrival, chunk_sum):
    """Sort particles by cell, those of a cell by index.

    Reads: cell (n,).
    Writes: order (n,), the k-th particle in cell order; cell_start (cells + 2,): cell c holds
        order[cell_start[c]:cell_start[c + 1]], c = nx ny nz the inactive ones.
    """
    order[:] = np.argsort(cell, kind="stable")
    cell_start[:] = np.searchsorted(cell[order], np.arange(cell_start.shape[0]))


def reorder_scalar(order, source, target):
    """Write target[k] = source[order[k]], shapes (n,)."""
    target[:] = source[order]


def reorder_vector(order, source, target):
    """Write target[:, k] = source[:, order[k]], shapes (components, n)."""
    target[:] = source[:, order]


def site_particle(phase, site, site_particle):
    """Write the solid particle at each lattice site, -1 where there is none.

    A melted particle keeps its site number (for freezing back and for files), so only solid
    particles count. No two of them have the same site.

    Reads: phase (n,), site (n,). Writes: site_particle (sites,).
    """
    site_particle[:] = -1
    i = np.flatnonzero((phase == 1) & (site >= 0))
    site_particle[site[i]] = i
