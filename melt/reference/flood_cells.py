r"""How far a search for neighbours has to go in each cell of the grid. Flood spec 1.5.

A cell at the Chebyshev distance k is at least k - 1 edges a away. Columns i and j are neighbours if
:math:`r < g \max(h_i, h_j)` with the growth g, so ring k matters if :math:`g h > (k - 1) a` for the largest
support of this cell or of some cell of the ring.
"""

import numpy as np


def cell_support(phase, support_radius, cell_start, cell_support):
    """Write the largest support of the columns in each cell, 0 without any; NaN counts as 0.

    Reads: phase (n,), support_radius (n,) [m], cell_start (cells + 2,).
    Writes: cell_support (cells + 2,) [m]; the last two entries, which are no cells, get 0.
    """
    h = np.where((phase == 0) | (phase == 6), np.nan_to_num(support_radius.astype(np.float64), nan=0.0), 0.0)
    for c in range(cell_start.shape[0] - 2):
        cell_support[c] = h[cell_start[c] : cell_start[c + 1]].max(initial=0.0)
    cell_support[-2:] = 0


def cell_reach(cell_support, cell_start, grid, flood, rings, empty, cell_reach):
    """Write the outermost ring that may hold neighbours of this cell's columns, at most ``rings``.

    It is at least 1 where there are columns. Cells without any get 0, or with ``empty`` = 1 the outermost ring
    with a column that reaches them.

    Reads: cell_support [m] and cell_start, (cells + 2,).
    Writes: cell_reach (cells + 2,); the last two entries get 0.
    """
    nx, cells = int(grid.nx), int(grid.nx) * int(grid.ny)
    h = cell_support[:cells].astype(np.float64)
    c_x, c_y = np.arange(cells) % nx, np.arange(cells) // nx
    cell_reach[:] = 0
    for c in range(cells):
        occupied = cell_start[c + 1] > cell_start[c]
        if not occupied and empty != 1:
            continue
        found = 1 if occupied else 0
        ring = np.maximum(abs(c_x - c_x[c]), abs(c_y - c_y[c]))
        for k in range(1, int(rings) + 1):
            most = max(h[c], h[ring == k].max(initial=0.0))
            if float(flood.growth) * most * float(grid.inverse_cell) > k - 1:
                found = k
        cell_reach[c] = found
