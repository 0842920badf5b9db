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
def copy_near(position, phase, volume, liquid, row, rows, middle, grid, period, x, y, z, weight, slot):
    """Append nodes (``liquid``), or the other particles, of the ranges to the buffers; return where they end.

    Particles are taken to their image nearest to the middle of the cell; of a periodic axis of fewer than
    three cells, to both images.
    """
    wide = type(middle[0])
    real = type(period.length_x)
    first = slot
    for r in range(rows):
        for j in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            if (phase[j] == LIQUID) != liquid or (liquid and not volume[j] > real(0)):
                continue
            x[slot] = image(position[0, j], middle[0], period.length_x, period.inverse_x)
            y[slot] = image(position[1, j], middle[1], period.length_y, period.inverse_y)
            z[slot] = image(position[2, j], middle[2], period.length_z, period.inverse_z)
            weight[slot] = volume[j]
            slot += 1
    if period.length_x > real(0) and grid.nx < 3:
        slot = _other_images(x, y, z, weight, first, slot, middle[0], wide(period.length_x))
    if period.length_y > real(0) and grid.ny < 3:
        slot = _other_images(y, x, z, weight, first, slot, middle[1], wide(period.length_y))
    if period.length_z > real(0) and grid.nz < 3:
        slot = _other_images(z, x, y, weight, first, slot, middle[2], wide(period.length_z))
    return slot


@cpu_helper
def copy_ghosts(ghost_position, row, rows, middle, grid, period, x, y, z, weight, slot):
    """Append the ghosts of the ranges to the buffers as `copy_near` does; return where they end."""
    wide = type(middle[0])
    real = type(period.length_x)
    first = slot
    for r in range(rows):
        for j in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            x[slot] = image(ghost_position[0, j], middle[0], period.length_x, period.inverse_x)
            y[slot] = image(ghost_position[1, j], middle[1], period.length_y, period.inverse_y)
            z[slot] = image(ghost_position[2, j], middle[2], period.length_z, period.inverse_z)
            weight[slot] = real(1)
            slot += 1
    if period.length_x > real(0) and grid.nx < 3:
        slot = _other_images(x, y, z, weight, first, slot, middle[0], wide(period.length_x))
    if period.length_y > real(0) and grid.ny < 3:
        slot = _other_images(y, x, z, weight, first, slot, middle[1], wide(period.length_y))
    if period.length_z > real(0) and grid.nz < 3:
        slot = _other_images(z, x, y, weight, first, slot, middle[2], wide(period.length_z))
    return slot


@cpu_helper
def buffers(size, position, like):
    """Return scratch for ``size`` particles with all their images: coordinates and weights."""
    wide = position.dtype
    return np.empty(8 * size, wide), np.empty(8 * size, wide), np.empty(8 * size, wide), np.empty(8 * size, like.dtype)


@cpu_helper
def cell_middle(grid, c_x, c_y, c_z, position):
    """Return the middle of a cell in the precision of positions [m]."""
    wide = position.dtype.type
    half, edge = wide(0.5), wide(1) / wide(grid.inverse_cell)
    return (
        wide(grid.origin_x) + (wide(c_x) + half) * edge,
        wide(grid.origin_y) + (wide(c_y) + half) * edge,
        wide(grid.origin_z) + (wide(c_z) + half) * edge,
    )
