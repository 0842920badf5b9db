"""CPU twin of `melt.reference.flood_cells`."""

import numpy as np

from melt._compile import cpu_serial, cpu_stage, prange
from melt.physics.flood import outermost_ring
from melt.physics.phases import AIRBORNE, LIQUID


@cpu_stage
def cell_support(phase, support_radius, cell_start, cell_support):
    """See `melt.reference.flood_cells.cell_support`."""
    cells = cell_support.shape[0] - 2
    for c in prange(cells + 2):
        most = cell_support.dtype.type(0)
        if c < cells:
            for i in range(np.uint64(cell_start[c]), np.uint64(cell_start[c + 1])):
                if (phase[i] == LIQUID or phase[i] == AIRBORNE) and support_radius[i] > most:
                    most = support_radius[i]
        cell_support[c] = most


@cpu_serial
def _most_around(cell_support, c_x, c_y, rings, grid):
    """Return the largest support within some rings of a cell: rows without branches."""
    most = cell_support.dtype.type(0)
    first, stop = max(c_x - rings, 0), min(c_x + rings + 1, grid.nx)
    for y in range(max(c_y - rings, 0), min(c_y + rings + 1, grid.ny)):
        row = np.uint64(grid.nx * y)
        for x in range(np.uint64(first), np.uint64(stop)):
            most = max(most, cell_support[row + x])
    return most


@cpu_serial
def _reach_of(cell_support, own, c_x, c_y, grid, flood, rings):
    """Return the outermost ring beyond ``own`` that holds a column which reaches this cell, or ``own``."""
    around = _most_around(cell_support, c_x, c_y, rings, grid)
    # no ring beyond the reach of the largest support matters, and mostly none beyond the cell's own
    farthest = outermost_ring(around, flood.growth, grid.inverse_cell, rings)
    reach = own
    if farthest <= own:
        return reach
    for y in range(max(c_y - farthest, 0), min(c_y + farthest + 1, grid.ny)):
        for x in range(max(c_x - farthest, 0), min(c_x + farthest + 1, grid.nx)):
            k = max(abs(x - c_x), abs(y - c_y))
            if k > reach and outermost_ring(cell_support[x + grid.nx * y], flood.growth, grid.inverse_cell, rings) >= k:
                reach = k
    return reach


@cpu_stage
def cell_reach(cell_support, cell_start, grid, flood, rings, empty, cell_reach):
    """See `melt.reference.flood_cells.cell_reach`."""
    cells = np.int64(grid.nx) * grid.ny
    for c in prange(cell_reach.shape[0]):
        reach = np.int64(0)
        occupied = c < cells and cell_start[c + 1] > cell_start[c]
        if occupied or (c < cells and empty == 1):
            own = np.int64(outermost_ring(cell_support[c], flood.growth, grid.inverse_cell, rings))
            if occupied:
                own = max(own, np.int64(1))
            reach = _reach_of(cell_support, own, c % grid.nx, c // grid.nx, grid, flood, np.int64(rings))
        cell_reach[c] = reach
