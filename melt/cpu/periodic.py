"""CPU twin of `melt.reference.periodic`. A plain search: periodic boxes are small scenes of validation."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.period import near_cell, wrap
from melt.physics.phases import INACTIVE, WALL
from melt.physics.search import axis_cell, squared_distance


@cpu_stage
def neighbours_periodic(
    position, phase, cell_start, grid, smoothing, period, neighbour_count, neighbour_index,
):
    """See `melt.reference.periodic.neighbours_periodic`. Cells are visited in ascending order, and so are particles."""
    real = type(smoothing.support)
    h2 = smoothing.support * smoothing.support
    for i in prange(phase.shape[0]):
        count = 0
        if phase[i] != WALL and phase[i] != INACTIVE:
            x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
            c_x = axis_cell(x_i, grid.origin_x, grid.inverse_cell, grid.nx)
            c_y = axis_cell(y_i, grid.origin_y, grid.inverse_cell, grid.ny)
            c_z = axis_cell(z_i, grid.origin_z, grid.inverse_cell, grid.nz)
            for at in range(27):
                x_cell = near_cell(c_x, at % 3, grid.nx, period.length_x)
                y_cell = near_cell(c_y, at // 3 % 3, grid.ny, period.length_y)
                z_cell = near_cell(c_z, at // 9, grid.nz, period.length_z)
                if x_cell < 0 or y_cell < 0 or z_cell < 0:
                    continue
                cell = x_cell + grid.nx * (y_cell + grid.ny * z_cell)
                for j in range(np.uint64(cell_start[cell]), np.uint64(cell_start[cell + 1])):
                    x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
                    y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
                    z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
                    if squared_distance(x, y, z) < h2 and np.int64(j) != i:
                        if count < neighbour_index.shape[1]:
                            neighbour_index[i, count] = j
                        count += 1
        neighbour_count[i] = count
