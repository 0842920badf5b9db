"""CPU twin of `melt.reference.ghost_sums`. Ghosts of a cell share what is around it, copied once."""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._ghost_rows import box_of, buffers, copy_ghosts, copy_near, near_rows, other_images
from melt.physics.search import axis_cell
from melt.physics.smoothing import W, dW_over_r

PIECES = 64


@cpu_helper
def _kernel_sum(x, y, z, stop, x_g, y_g, z_g, smoothing):
    real = type(smoothing.support)
    total = real(0)
    for k in range(np.uint64(stop)):
        d_x, d_y, d_z = real(x_g - x[k]), real(y_g - y[k]), real(z_g - z[k])
        total += W(math.sqrt(d_x * d_x + d_y * d_y + d_z * d_z), smoothing)
    return total


@cpu_helper
def _piece_volumes(
    position, phase, volume, cell_start, ghost_position, ghost_start, grid, smoothing, period, ghost_volume, first, stop,
):
    real = type(smoothing.support)
    cells = np.int64(grid.nx) * grid.ny * grid.nz
    active, number = np.int64(cell_start[cells]), np.int64(ghost_position.shape[1])
    row = np.empty((27, 2), np.int64)
    row_g = np.empty((27, 2), np.int64)
    most = np.int64(512)
    x, y, z, weight = buffers(most, position, volume)
    for c in range(first, stop):
        begin, end = min(np.int64(ghost_start[c]), number), min(np.int64(ghost_start[c + 1]), number)
        if begin == end:
            continue
        c_x, c_y, c_z = c % grid.nx, c // grid.nx % grid.ny, c // (grid.nx * grid.ny)
        rows, total = near_rows(cell_start, active, grid, period, c_x, c_y, c_z, row)
        rows_g, total_g = near_rows(ghost_start, number, grid, period, c_x, c_y, c_z, row_g)
        if total + total_g > most:
            most = 2 * (total + total_g)
            x, y, z, weight = buffers(most, position, volume)
        box = box_of(grid, smoothing, period, c_x, c_y, c_z, position)
        slot = copy_near(position, phase, volume, True, row, rows, box, period, x, y, z, weight, 0)
        slot = copy_near(position, phase, volume, False, row, rows, box, period, x, y, z, weight, slot)
        slot = copy_ghosts(ghost_position, ghost_volume, row_g, rows_g, box, period, x, y, z, weight, slot)
        slot = other_images(box, grid, period, x, y, z, weight, 0, slot)
        for g in range(begin, end):
            total_w = _kernel_sum(
                x, y, z, slot, ghost_position[0, g], ghost_position[1, g], ghost_position[2, g], smoothing
            )
            ghost_volume[g] = real(1) / total_w


@cpu_stage
def ghost_volume(
    position, phase, volume, cell_start, ghost_position, ghost_start, grid, smoothing, period, ghost_volume,
):
    """See `melt.reference.ghost_sums.ghost_volume`."""
    cells = np.int64(grid.nx) * grid.ny * grid.nz
    pieces = 8 * PIECES
    for chunk in prange(pieces):
        piece = (chunk * 37) % pieces
        _piece_volumes(
            position, phase, volume, cell_start, ghost_position, ghost_start, grid, smoothing, period, ghost_volume,
            cells * piece // pieces, cells * (piece + 1) // pieces,
        )


@cpu_helper
def _ghosts_of(x, y, z, weight, stop, x_i, y_i, z_i, smoothing, poisson):
    """Return the ghosts' share of the density ratio of a particle, and their part in its Laplacian."""
    real = type(smoothing.support)
    ratio = laplacian = real(0)
    for k in range(np.uint64(stop)):
        d_x, d_y, d_z = real(x_i - x[k]), real(y_i - y[k]), real(z_i - z[k])
        r2 = d_x * d_x + d_y * d_y + d_z * d_z
        ratio += weight[k] * W(math.sqrt(r2), smoothing)
        laplacian -= weight[k] * dW_over_r(r2, smoothing) * (r2 / (r2 + poisson.floor))
    return ratio, laplacian


@cpu_helper
def _piece_complete(
    position, density_ratio, dfsph_factor, ghost_position, ghost_volume, ghost_start, grid, smoothing, period, poisson,
    completed_ratio, ghost_laplacian, first, stop,
):
    real = type(smoothing.support)
    number = np.int64(ghost_position.shape[1])
    row = np.empty((27, 2), np.int64)
    most = np.int64(256)
    x, y, z, weight = buffers(most, position, ghost_volume)
    cell, ghosts = np.int64(-1), np.int64(0)
    for i in range(first, stop):
        s = density_ratio[i]
        completed_ratio[i] = s
        ghost_laplacian[i] = real(0)
        if not dfsph_factor[i] > real(0):
            continue
        c_x = axis_cell(position[0, i], grid.origin_x, grid.inverse_cell, grid.nx)
        c_y = axis_cell(position[1, i], grid.origin_y, grid.inverse_cell, grid.ny)
        c_z = axis_cell(position[2, i], grid.origin_z, grid.inverse_cell, grid.nz)
        c = c_x + np.int64(grid.nx) * (c_y + np.int64(grid.ny) * c_z)
        if c != cell:  # particles are in the order of cells: those of one share what is around it
            cell = c
            rows, total = near_rows(ghost_start, number, grid, period, c_x, c_y, c_z, row)
            if total > most:
                most = 2 * total
                x, y, z, weight = buffers(most, position, ghost_volume)
            box = box_of(grid, smoothing, period, c_x, c_y, c_z, position)
            ghosts = copy_ghosts(ghost_position, ghost_volume, row, rows, box, period, x, y, z, weight, 0)
            ghosts = other_images(box, grid, period, x, y, z, weight, 0, ghosts)
        if ghosts > 0:
            more, laplacian = _ghosts_of(
                x, y, z, weight, ghosts, position[0, i], position[1, i], position[2, i], smoothing, poisson
            )
            completed_ratio[i] = min(s + more, max(s, real(1)))
            ghost_laplacian[i] = laplacian


@cpu_stage
def ghost_complete(
    position, density_ratio, dfsph_factor, ghost_position, ghost_volume, ghost_start, grid, smoothing, period, poisson,
    completed_ratio, ghost_laplacian,
):
    """See `melt.reference.ghost_sums.ghost_complete`."""
    n = density_ratio.shape[0]
    for piece in prange(PIECES):
        _piece_complete(
            position, density_ratio, dfsph_factor, ghost_position, ghost_volume, ghost_start, grid, smoothing, period,
            poisson, completed_ratio, ghost_laplacian, n * piece // PIECES, n * (piece + 1) // PIECES,
        )
