"""CPU twin of `melt.reference.ghosts`.

The points of a cell share the particles around it, copied once to buffers. Particles close to the cell are
compared with its points; those that are near none, in air or in holes, sum up the liquid in one long loop
without branches.
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._ghost_rows import box_of, buffers, copy_near, near_box, near_rows, other_images
from melt.cpu._ghost_thin import thin_rows
from melt.physics.ghosts import (
    CANDIDATE,
    GHOST,
    NONE,
    in_box,
    jitter_units,
    point_coordinate,
    point_shift,
)
from melt.physics.search import axis_cell
from melt.physics.smoothing import W

PIECES = 64


@cpu_helper
def _any_liquid(phase, volume, row, rows):
    for r in range(rows):
        for j in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            if phase[j] == 0 and volume[j] > 0:
                return True
    return False


@cpu_helper
def _points(c, layers, grid, ghosts, p_x, p_y, p_z):
    """Write the positions of the points of a cell."""
    c_x, c_y, c_z = c % grid.nx, c // grid.nx % grid.ny, c // (np.int64(grid.nx) * grid.ny)
    like = p_x[0]
    across = np.int64(ghosts.across)
    p = np.int64(0)
    for k in range(across):
        for j in range(layers):
            for i in range(across):
                x, y, z = point_shift(c * p_x.shape[0] + p, ghosts)
                p_x[p] = point_coordinate(c_x * across + i, x, grid.origin_x, ghosts.pitch, like)
                p_y[p] = point_coordinate(c_y * across + j, y, grid.origin_y, ghosts.pitch, like)
                p_z[p] = point_coordinate(c_z * across + k, z, grid.origin_z, ghosts.pitch, like)
                if ghosts.flat:
                    p_y[p] = ghosts.plane
                p += 1


@cpu_helper
def _lattice_range(t, reach, count):
    """Return the first and the last lattice number (of 0 .. count-1) within reach of t; NaN reaches none."""
    low, high = t - reach, t + reach
    if not (low <= type(t)(count - 1) and high >= type(t)(0)):
        return np.int64(0), np.int64(-1)
    return np.int64(math.ceil(max(low, type(t)(0)))), np.int64(min(high, type(t)(count - 1)))


@cpu_helper
def _near_cell(x, y, z, stop, box, reach, hit):
    """Mark the particles closer than ``reach`` to a cell."""
    wide = type(box[0])
    for k in range(np.uint64(stop)):
        hit[k] = near_box(x[k], y[k], z[k], box, wide(reach))


@cpu_helper
def _nearest(x, y, z, stop, hit, p_x, p_y, p_z, corner, layers, ghosts, nearest):
    """Write the squared distance of each point to the nearest particle, where it is below ``distance``.

    A particle looks through whole layers of points: one long loop takes half the time of short ones along rows.
    """
    real = type(ghosts.pitch)
    across = np.int64(ghosts.across)
    scale, half = real(1) / ghosts.pitch, real(0.5)
    # a hundredth more than what rounding could ask for
    reach = ghosts.distance * scale + real(jitter_units(ghosts)) * real(1 / 128) + real(0.01)
    for p in range(np.uint64(nearest.shape[0])):
        nearest[p] = real(math.inf)
    for k in range(np.uint64(stop)):
        if hit[k] == 0:
            continue
        first, last = _lattice_range(real(z[k] - corner) * scale - half, reach, across)
        x_k, y_k, z_k = x[k], y[k], z[k]
        for p in range(np.uint64(first * across * layers), np.uint64((last + 1) * across * layers)):
            d_x, d_y, d_z = real(p_x[p] - x_k), real(p_y[p] - y_k), real(p_z[p] - z_k)
            r2 = d_x * d_x + d_y * d_y + d_z * d_z
            nearest[p] = r2 if r2 < nearest[p] else nearest[p]


@cpu_helper
def _in_air(x, y, z, weight, liquids, p_x, p_y, p_z, smoothing, ghosts):
    """Return whether liquid is within the support of a point, and fills less than ``fill`` of it."""
    real = type(smoothing.support)
    h2 = smoothing.support * smoothing.support
    near, fill = real(0), real(0)
    for k in range(np.uint64(liquids)):
        d_x, d_y, d_z = real(p_x - x[k]), real(p_y - y[k]), real(p_z - z[k])
        r2 = d_x * d_x + d_y * d_y + d_z * d_z
        near += real(1) if r2 < h2 else real(0)
        fill += weight[k] * W(math.sqrt(r2), smoothing)
    return near > real(0) and fill < ghosts.fill


@cpu_helper
def _cell_candidates(c, layers, grid, smoothing, period, ghosts, near, points, nearest, hit, ghost_state):
    """Write the states of the points of a cell from the particles around it."""
    x, y, z, weight, liquids, stop, box = near
    p_x, p_y, p_z = points
    size = p_x.shape[0]
    _points(c, layers, grid, ghosts, p_x, p_y, p_z)
    _near_cell(x, y, z, stop, box, type(ghosts.pitch)(1.01) * ghosts.distance, hit)
    _nearest(x, y, z, stop, hit, p_x, p_y, p_z, box[2] - box[5], layers, ghosts, nearest)
    d2 = ghosts.distance * ghosts.distance
    for p in range(size):
        state = NONE
        if nearest[p] >= d2 and in_box(p_x[p], period.lower_x, period.length_x):
            if in_box(p_y[p], period.lower_y, period.length_y) and in_box(p_z[p], period.lower_z, period.length_z):
                if _in_air(x, y, z, weight, liquids, p_x[p], p_y[p], p_z[p], smoothing, ghosts):
                    state = CANDIDATE
        ghost_state[c * size + p] = state


@cpu_helper
def _piece_candidates(
    position, phase, volume, cell_start, grid, smoothing, period, ghosts, ghost_state, first, stop,
):
    across = np.int64(ghosts.across)
    layers = np.int64(1) if ghosts.flat else across
    size = across * layers * across
    layer = axis_cell(position.dtype.type(ghosts.plane), grid.origin_y, grid.inverse_cell, grid.ny)
    active = np.int64(cell_start[np.int64(grid.nx) * grid.ny * grid.nz])
    row = np.empty((27, 2), np.int64)
    most = np.int64(512)
    x, y, z, weight = buffers(most, position, volume)
    points = np.empty(size, position.dtype), np.empty(size, position.dtype), np.empty(size, position.dtype)
    nearest, hit = np.empty(size, volume.dtype), np.empty(x.shape[0], np.uint8)
    for c in range(first, stop):
        c_x, c_y, c_z = c % grid.nx, c // grid.nx % grid.ny, c // (grid.nx * grid.ny)
        rows, total = near_rows(cell_start, active, grid, period, c_x, c_y, c_z, row)
        if (ghosts.flat and c_y != layer) or not _any_liquid(phase, volume, row, rows):
            for p in range(np.uint64(c * size), np.uint64(c * size + size)):
                ghost_state[p] = NONE
            continue
        if total > most:  # a crowded cell
            most = 2 * total
            x, y, z, weight = buffers(most, position, volume)
            hit = np.empty(x.shape[0], np.uint8)
        box = box_of(grid, smoothing, period, c_x, c_y, c_z, position)
        liquids = copy_near(position, phase, volume, True, row, rows, box, period, x, y, z, weight, 0)
        liquids = other_images(box, grid, period, x, y, z, weight, 0, liquids)
        stop = copy_near(position, phase, volume, False, row, rows, box, period, x, y, z, weight, liquids)
        stop = other_images(box, grid, period, x, y, z, weight, liquids, stop)
        near = x, y, z, weight, liquids, stop, box
        _cell_candidates(c, layers, grid, smoothing, period, ghosts, near, points, nearest, hit, ghost_state)


@cpu_stage
def ghost_candidates(position, phase, volume, cell_start, grid, smoothing, period, ghosts, ghost_state):
    """See `melt.reference.ghosts.ghost_candidates`."""
    cells = np.int64(grid.nx) * grid.ny * grid.nz
    pieces = 8 * PIECES  # dealt out: the surface is somewhere
    for chunk in prange(pieces):
        piece = (chunk * 37) % pieces
        _piece_candidates(
            position, phase, volume, cell_start, grid, smoothing, period, ghosts, ghost_state,
            cells * piece // pieces, cells * (piece + 1) // pieces,
        )


@cpu_stage
def ghost_thin(grid, period, ghosts, ghost_state):
    """See `melt.reference.ghosts.ghost_thin`. Cells of a turn do not see each other: threads share them."""
    real = type(period.length_x)
    turns_x = 3 if period.length_x > real(0) and grid.nx % 2 else 2
    turns_y = 3 if period.length_y > real(0) and grid.ny % 2 else 2
    turns_z = 3 if period.length_z > real(0) and grid.nz % 2 else 2
    for turn in range(turns_x * turns_y * turns_z):
        t_x, t_y, t_z = turn % turns_x, turn // turns_x % turns_y, turn // (turns_x * turns_y)
        for chunk in prange(PIECES):
            piece = (chunk * 37) % PIECES
            thin_rows(ghost_state, grid, period, ghosts, t_x, t_y, t_z, piece, PIECES)


@cpu_stage
def ghost_list(ghost_state, grid, ghosts, ghost_start, chunk_sum):
    """See `melt.reference.ghosts.ghost_list`. `chunk_sum` is used by the CUDA twin only."""
    cells = np.int64(grid.nx) * grid.ny * grid.nz
    size = np.int64(ghosts.across) * ghosts.across * (1 if ghosts.flat else ghosts.across)
    for c in prange(cells):
        count = np.int32(0)
        for q in range(np.uint64(c * size), np.uint64(c * size + size)):
            count += np.int32(1) if ghost_state[q] == GHOST else np.int32(0)
        ghost_start[c] = count
    total = np.int32(0)
    for c in range(cells):
        count = ghost_start[c]
        ghost_start[c] = total
        total += count
    ghost_start[cells] = total
    ghost_start[cells + 1] = total


@cpu_stage
def ghost_place(ghost_state, ghost_start, grid, ghosts, ghost_position):
    """See `melt.reference.ghosts.ghost_place`."""
    like = ghost_position.dtype.type(0)
    across = np.int64(ghosts.across)
    layers = np.int64(1) if ghosts.flat else across
    size = across * layers * across
    for c in prange(np.int64(grid.nx) * grid.ny * grid.nz):
        slot = np.int64(ghost_start[c])
        if ghost_start[c + 1] == slot:
            continue
        c_x, c_y, c_z = c % grid.nx, c // grid.nx % grid.ny, c // (grid.nx * grid.ny)
        for p in range(size):
            if ghost_state[c * size + p] != GHOST or slot >= ghost_position.shape[1]:
                continue
            x, y, z = point_shift(c * size + p, ghosts)
            i, j, k = p % across, p // across % layers, p // (across * layers)
            ghost_position[0, slot] = point_coordinate(c_x * across + i, x, grid.origin_x, ghosts.pitch, like)
            flat_y = point_coordinate(c_y * across + j, y, grid.origin_y, ghosts.pitch, like)
            ghost_position[1, slot] = ghosts.plane if ghosts.flat else flat_y
            ghost_position[2, slot] = point_coordinate(c_z * across + k, z, grid.origin_z, ghosts.pitch, like)
            slot += 1
