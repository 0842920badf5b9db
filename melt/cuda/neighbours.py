"""CUDA twin of `melt.reference.neighbours`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import INACTIVE, WALL
from melt.physics.search import axis_cell, squared_distance


@cuda_kernel
def _neighbours_grid(
    position, phase, cell_start, grid, smoothing, neighbour_count, neighbour_index,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    neighbour_count[i] = 0
    if phase[i] == WALL or phase[i] == INACTIVE:
        return
    real = type(smoothing.support)
    h2 = smoothing.support * smoothing.support
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    c_x = axis_cell(x_i, grid.origin_x, grid.inverse_cell, grid.nx)
    c_y = axis_cell(y_i, grid.origin_y, grid.inverse_cell, grid.ny)
    c_z = axis_cell(z_i, grid.origin_z, grid.inverse_cell, grid.nz)
    first_x, last_x = max(c_x - 1, 0), min(c_x + 1, grid.nx - 1)
    count = 0
    for z_cell in range(max(c_z - 1, 0), min(c_z + 2, grid.nz)):
        for y_cell in range(max(c_y - 1, 0), min(c_y + 2, grid.ny)):
            row = grid.nx * (y_cell + grid.ny * z_cell)
            for j in range(cell_start[row + first_x], cell_start[row + last_x + 1]):
                x = real(x_i - position[0, j])
                y = real(y_i - position[1, j])
                z = real(z_i - position[2, j])
                if squared_distance(x, y, z) < h2 and j != i:
                    if count < neighbour_index.shape[1]:
                        neighbour_index[i, count] = j
                    count += 1
    neighbour_count[i] = count


def neighbours_grid(
    position, phase, cell_start, grid, smoothing, neighbour_count, neighbour_index,
):
    """See `melt.reference.neighbours.neighbours_grid`."""
    _neighbours_grid.launch(
        phase.shape[0], position, phase, cell_start, grid, smoothing, neighbour_count,
        neighbour_index,
    )
