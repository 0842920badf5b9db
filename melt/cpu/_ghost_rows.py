"""Particles and ghosts around a cell, for the CPU twins of air ghost particles."""

import numpy as np

from melt._compile import cpu_helper
from melt.physics.ghosts import image
from melt.physics.period import near_cell
from melt.physics.phases import LIQUID


@cpu_helper
def near_box(x, y, z, box, reach):
    """Return whether a place is closer than ``reach`` to the cell."""
    wide = type(x)
    d_x = max(abs(x - box[0]) - box[3], wide(0))
    d_y = max(abs(y - box[1]) - box[4], wide(0))
    d_z = max(abs(z - box[2]) - box[5], wide(0))
    return d_x * d_x + d_y * d_y + d_z * d_z < reach * reach


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

    Particles are taken to their image nearest to the middle of the cell; those out of reach of the
    cell are left out. ``box`` is that of `box_of`.
    """
    real = type(period.length_x)
    for r in range(rows):
        for j in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            if (phase[j] == LIQUID) != liquid or (liquid and not volume[j] > real(0)):
                continue
            x_j = image(position[0, j], box[0], period.length_x, period.inverse_x)
            y_j = image(position[1, j], box[1], period.length_y, period.inverse_y)
            z_j = image(position[2, j], box[2], period.length_z, period.inverse_z)
            x[slot], y[slot], z[slot], weight[slot] = x_j, y_j, z_j, volume[j]
            slot += 1 if near_box(x_j, y_j, z_j, box, box[6]) else 0
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
def copy_ghosts(ghost_position, ghost_volume, row, rows, box, period, x, y, z, weight, slot):
    """Append the ghosts of the ranges to the buffers as `copy_near` does; return where they end."""
    for r in range(rows):
        for j in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            x_j = image(ghost_position[0, j], box[0], period.length_x, period.inverse_x)
            y_j = image(ghost_position[1, j], box[1], period.length_y, period.inverse_y)
            z_j = image(ghost_position[2, j], box[2], period.length_z, period.inverse_z)
            x[slot], y[slot], z[slot], weight[slot] = x_j, y_j, z_j, ghost_volume[j]
            slot += 1 if near_box(x_j, y_j, z_j, box, box[6]) else 0
    return slot


@cpu_helper
def buffers(size, position, like):
    """Return scratch for ``size`` particles with all their images, and one more: coordinates and weights."""
    wide, most = position.dtype, 8 * size + 1
    return np.empty(most, wide), np.empty(most, wide), np.empty(most, wide), np.empty(most, like.dtype)


@cpu_helper
def _middle(cell, count, origin, length, edge):
    """Return the middle of a cell along an axis, and half its edge; the last of a periodic axis ends where the axis does."""
    half = edge / type(edge)(2)
    if length > type(edge)(0) and cell == count - 1:
        half = max(length - type(edge)(count - 1) * edge, edge) / type(edge)(2)
    return origin + type(edge)(cell) * edge + half, half


@cpu_helper
def box_of(grid, smoothing, period, c_x, c_y, c_z, position):
    """Return the middle of a cell, half its edges, and the support with some slack, in the precision of positions [m]."""
    wide = position.dtype.type
    edge = wide(1) / wide(grid.inverse_cell)
    x, half_x = _middle(c_x, grid.nx, wide(grid.origin_x), wide(period.length_x), edge)
    y, half_y = _middle(c_y, grid.ny, wide(grid.origin_y), wide(period.length_y), edge)
    z, half_z = _middle(c_z, grid.nz, wide(grid.origin_z), wide(period.length_z), edge)
    return x, y, z, half_x, half_y, half_z, wide(1.01) * wide(smoothing.support)
