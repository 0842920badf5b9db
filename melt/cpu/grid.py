"""CPU twin of `melt.reference.grid`."""

import numpy as np

from melt._compile import cpu_serial, cpu_stage, prange
from melt.physics.phases import INACTIVE, SOLID
from melt.physics.search import axis_cell


@cpu_stage
def cell_index(position, phase, grid, cell):
    """See `melt.reference.grid.cell_index`."""
    for i in prange(phase.shape[0]):
        if phase[i] == INACTIVE:
            cell[i] = grid.nx * grid.ny * grid.nz
            continue
        x = axis_cell(position[0, i], grid.origin_x, grid.inverse_cell, grid.nx)
        y = axis_cell(position[1, i], grid.origin_y, grid.inverse_cell, grid.ny)
        z = axis_cell(position[2, i], grid.origin_z, grid.inverse_cell, grid.nz)
        cell[i] = x + grid.nx * (y + grid.ny * z)


@cpu_serial
def cell_sort(cell, order, cell_start, arrival, chunk_sum):
    """See `melt.reference.grid.cell_sort`.

    One thread: counting and placing 60k particles take 0.2 ms; two threads with their own
    histograms took longer. `arrival` and `chunk_sum` are used by the CUDA twin only.
    """
    cells = cell_start.shape[0]
    for c in range(cells):
        cell_start[c] = 0
    for i in range(cell.shape[0]):
        cell_start[np.uint64(cell[i])] += 1
    total = np.int32(0)
    for c in range(cells):  # the end of cell c, then counted down to its start
        total += cell_start[c]
        cell_start[c] = total
    for i in range(cell.shape[0] - 1, -1, -1):
        c = np.uint64(cell[i])
        k = cell_start[c] - np.int32(1)
        cell_start[c] = k
        order[np.uint64(k)] = i


@cpu_stage
def reorder_scalar(order, source, target):
    """See `melt.reference.grid.reorder_scalar`."""
    for k in prange(order.shape[0]):
        target[k] = source[np.uint64(order[k])]


@cpu_stage
def reorder_vector(order, source, target):
    """See `melt.reference.grid.reorder_vector`."""
    for k in prange(order.shape[0]):
        j = np.uint64(order[k])
        for a in range(source.shape[0]):
            target[a, k] = source[a, j]


@cpu_stage
def site_particle(phase, site, site_particle):
    """See `melt.reference.grid.site_particle`."""
    for s in prange(site_particle.shape[0]):
        site_particle[s] = -1
    for i in prange(phase.shape[0]):
        if phase[i] == SOLID and site[i] >= 0:
            site_particle[site[i]] = i
