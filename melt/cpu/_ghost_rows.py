"""Particles and ghosts around a cell, for the CPU twins of air ghost particles."""

import numpy as np

from melt._compile import cpu_helper
from melt.physics.ghosts import image
from melt.physics.period import near_cell
from melt.physics.phases import LIQUID


@cpu_helper
def near_rows(start, most, grid, period, c_x, c_y, c_z, row):
    """Fill row (27, 2) with the ranges below ``most`` of the cells around a cell; return their number and total."""
    rows = total = np.int64(0)
    real = type(period.length_x)
    single = period.length_x > real(0)  # cells of a row are contiguous unless the row is closed to a ring
    for a in range(3):
        z = near_cell(c_z, a, grid.nz, period.length_z)
        if z < 0:
            continue
        for b in range(3):
            y = near_cell(c_y, b, grid.ny, period.length_y)
            if y < 0:
                continue
            line = np.int64(grid.nx) * (y + np.int64(grid.ny) * z)
            for d in range(3 if single else 1):
                first = near_cell(c_x, d, grid.nx, period.length_x) if single else max(c_x - 1, 0)
                last = first if single else min(c_x + 1, grid.nx - 1)
                if first < 0:
                    continue
                low, high = min(np.int64(start[line + first]), most), min(np.int64(start[line + last + 1]), most)
                if high > low:
                    row[rows, 0], row[rows, 1] = low, high
                    rows += 1
                    total += high - low
    return rows, total


@cpu_helper
def _other_images(x, y, z, weight, first, stop, middle, length):
    """Append the second-nearest image along the axis of the first array; return the new stop."""
    slot = stop
    for k in range(first, stop):
        x[slot] = x[k] + length if x[k] < middle else x[k] - length
        y[slot], z[slot], weight[slot] = y[k], z[k], weight[k]
        slot += 1
    return slot


@cpu_helper
def copy_near(position, phase, volume, liquid, row, rows, box, period, x, y, z, weight, slot):
    """Append nodes (``liquid``), or the other particles, of the ranges to the buffers; return where they end.

    Particles are taken to their image nearest to the middle of the cell; those farther than ``reach`` from the
    cell are left out. ``box`` is (middle x, y, z, half an edge, reach).
    """
    real = type(period.length_x)
    wide = type(box[0])
    for r in range(rows):
        for j in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            if (phase[j] == LIQUID) != liquid or (liquid and not volume[j] > real(0)):
                continue
            x_j = image(position[0, j], box[0], period.length_x, period.inverse_x)
            y_j = image(position[1, j], box[1], period.length_y, period.inverse_y)
            z_j = image(position[2, j], box[2], period.length_z, period.inverse_z)
            d_x = max(abs(x_j - box[0]) - box[3], wide(0))
            d_y = max(abs(y_j - box[1]) - box[3], wide(0))
            d_z = max(abs(z_j - box[2]) - box[3], wide(0))
            x[slot], y[slot], z[slot], weight[slot] = x_j, y_j, z_j, volume[j]
            slot += 1 if d_x * d_x + d_y * d_y + d_z * d_z < box[4] * box[4] else 0
    return slot


@cpu_helper
def other_images(box, grid, period, x, y, z, weight, first, slot):
    """Append the other image of what the buffers hold from ``first`` on, along periodic axes of two cells."""
    wide = type(box[0])
    real = type(period.length_x)
    if period.length_x > real(0) and grid.nx < 3:
        slot = _other_images(x, y, z, weight, first, slot, box[0], wide(period.length_x))
    if period.length_y > real(0) and grid.ny < 3:
        slot = _other_images(y, x, z, weight, first, slot, box[1], wide(period.length_y))
    if period.length_z > real(0) and grid.nz < 3:
        slot = _other_images(z, x, y, weight, first, slot, box[2], wide(period.length_z))
    return slot


@cpu_helper
def copy_ghosts(ghost_position, row, rows, box, period, x, y, z, slot):
    """Append the ghosts of the ranges to the buffers as `copy_near` does; return where they end."""
    for r in range(rows):
        for j in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            x[slot] = image(ghost_position[0, j], box[0], period.length_x, period.inverse_x)
            y[slot] = image(ghost_position[1, j], box[1], period.length_y, period.inverse_y)
            z[slot] = image(ghost_position[2, j], box[2], period.length_z, period.inverse_z)
            slot += 1
    return slot


@cpu_helper
def buffers(size, position, like):
    """Return scratch for ``size`` particles with all their images, and one more: coordinates and weights."""
    wide, most = position.dtype, 8 * size + 1
    return np.empty(most, wide), np.empty(most, wide), np.empty(most, wide), np.empty(most, like.dtype)


@cpu_helper
def box_of(grid, smoothing, c_x, c_y, c_z, position):
    """Return the middle of a cell, half its edge, and the support with some slack, in the precision of positions [m]."""
    wide = position.dtype.type
    half, edge = wide(0.5), wide(1) / wide(grid.inverse_cell)
    return (
        wide(grid.origin_x) + (wide(c_x) + half) * edge,
        wide(grid.origin_y) + (wide(c_y) + half) * edge,
        wide(grid.origin_z) + (wide(c_z) + half) * edge,
        half * edge,
        wide(1.01) * wide(smoothing.support),
    )
