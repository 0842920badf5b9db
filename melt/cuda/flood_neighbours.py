"""CUDA twin of `melt.reference.flood_neighbours`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.flood import outermost_ring, squared_in_plane, squared_reach
from melt.physics.phases import AIRBORNE, LIQUID
from melt.physics.search import axis_cell


@cuda_kernel
def _flood_neighbours(
    position, phase, support_radius, cell_start, cell_reach, grid, flood, neighbour_count, neighbour_index,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    neighbour_count[i] = 0
    if phase[i] != LIQUID and phase[i] != AIRBORNE:
        return
    real = type(flood.growth)
    x_i, y_i = position[0, i], position[1, i]
    own = squared_reach(support_radius[i], flood)
    c_x = axis_cell(x_i, grid.origin_x, grid.inverse_cell, grid.nx)
    c_y = axis_cell(y_i, grid.origin_y, grid.inverse_cell, grid.ny)
    rings = cell_reach[c_x + grid.nx * c_y]
    first_x, last_x = max(c_x - rings, 0), min(c_x + rings, grid.nx - 1)
    count = 0
    for y_cell in range(max(c_y - rings, 0), min(c_y + rings + 1, grid.ny)):
        row = grid.nx * y_cell
        for j in range(cell_start[row + first_x], cell_start[row + last_x + 1]):
            x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
            near = squared_in_plane(x, y) < max(own, squared_reach(support_radius[j], flood))
            if near and phase[j] == LIQUID and j != i:
                if count < neighbour_index.shape[1]:
                    neighbour_index[i, count] = j
                count += 1
    neighbour_count[i] = count


def flood_neighbours(
    position, phase, support_radius, cell_start, cell_reach, grid, flood, neighbour_count, neighbour_index,
):
    """See `melt.reference.flood_neighbours.flood_neighbours`."""
    _flood_neighbours.launch(
        phase.shape[0], position, phase, support_radius, cell_start, cell_reach, grid, flood, neighbour_count,
        neighbour_index,
    )


@cuda_kernel
def _wall_neighbours(
    position, phase, support_radius, boundary_position, boundary_start, boundary_ring, grid, flood, wall_count, wall_index,
):
    i = cuda.grid(1)
    if i >= wall_count.shape[0]:
        return
    wall_count[i] = 0
    if phase[i] != LIQUID:
        return
    real = type(flood.growth)
    x_i, y_i = position[0, i], position[1, i]
    own = squared_reach(support_radius[i], flood)
    c_x = axis_cell(x_i, grid.origin_x, grid.inverse_cell, grid.nx)
    c_y = axis_cell(y_i, grid.origin_y, grid.inverse_cell, grid.ny)
    rings = outermost_ring(support_radius[i], flood.growth, grid.inverse_cell, max(grid.nx, grid.ny))
    if boundary_ring[c_x + grid.nx * c_y] > rings:
        return
    first_x, last_x = max(c_x - rings, 0), min(c_x + rings, grid.nx - 1)
    count = 0
    for y_cell in range(max(c_y - rings, 0), min(c_y + rings + 1, grid.ny)):
        row = grid.nx * y_cell
        for j in range(boundary_start[row + first_x], boundary_start[row + last_x + 1]):
            x, y = real(x_i - boundary_position[0, j]), real(y_i - boundary_position[1, j])
            if squared_in_plane(x, y) < own:
                if count < wall_index.shape[1]:
                    wall_index[i, count] = j
                count += 1
    wall_count[i] = count


def wall_neighbours(
    position, phase, support_radius, boundary_position, boundary_start, boundary_ring, grid, flood, wall_count, wall_index,
):
    """See `melt.reference.flood_neighbours.wall_neighbours`."""
    _wall_neighbours.launch(
        wall_count.shape[0], position, phase, support_radius, boundary_position, boundary_start, boundary_ring, grid,
        flood, wall_count, wall_index,
    )
