"""CUDA twin of `melt.reference.flood_cells`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.flood import outermost_ring
from melt.physics.phases import AIRBORNE, LIQUID


@cuda_kernel
def _cell_support(phase, support_radius, cell_start, cell_support):
    c = cuda.grid(1)
    cells = cell_support.shape[0] - 2
    if c >= cells + 2:
        return
    most = cell_support.dtype.type(0)
    if c < cells:
        for i in range(cell_start[c], cell_start[c + 1]):
            if (phase[i] == LIQUID or phase[i] == AIRBORNE) and support_radius[i] > most:
                most = support_radius[i]
    cell_support[c] = most


def cell_support(phase, support_radius, cell_start, cell_support):
    """See `melt.reference.flood_cells.cell_support`."""
    _cell_support.launch(cell_support.shape[0], phase, support_radius, cell_start, cell_support)


@cuda_kernel
def _cell_reach(cell_support, cell_start, grid, flood, rings, empty, cell_reach):
    c = cuda.grid(1)
    if c >= cell_reach.shape[0]:
        return
    cell_reach[c] = 0
    if c >= grid.nx * grid.ny:
        return
    occupied = cell_start[c + 1] > cell_start[c]
    if not occupied and empty != 1:
        return
    reach = max(outermost_ring(cell_support[c], flood.growth, grid.inverse_cell, rings), 1 if occupied else 0)
    c_x, c_y = c % grid.nx, c // grid.nx
    for y in range(max(c_y - rings, 0), min(c_y + rings + 1, grid.ny)):
        for x in range(max(c_x - rings, 0), min(c_x + rings + 1, grid.nx)):
            k = max(abs(x - c_x), abs(y - c_y))
            if k > reach and outermost_ring(cell_support[x + grid.nx * y], flood.growth, grid.inverse_cell, rings) >= k:
                reach = k
    cell_reach[c] = reach


def cell_reach(cell_support, cell_start, grid, flood, rings, empty, cell_reach):
    """See `melt.reference.flood_cells.cell_reach`."""
    _cell_reach.launch(cell_reach.shape[0], cell_support, cell_start, grid, flood, rings, empty, cell_reach)
