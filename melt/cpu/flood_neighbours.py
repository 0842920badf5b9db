"""CPU twin of `melt.reference.flood_neighbours`.

The columns of a strip of cells along x share their candidates: of the rows of cells within reach, those columns
are copied to a buffer that come near the box around the strip, and the buffer is searched for each column of the
strip in one loop without branches. In deep water, where columns are narrow, a strip is one cell; where they are
wide it is as many cells as hold a handful of columns. The box test drops what a column far off with a large
support made the strip look at. It never drops a neighbour: rounding is monotone, so the distance of the box,
squared, is at most that of the column.
"""

import numpy as np

from melt._compile import cpu_helper, cpu_serial, cpu_stage, prange
from melt.cpu._compress import AVAILABLE, LANES, append_in_reach, append_near_box
from melt.physics.flood import outermost_ring, squared_in_plane, squared_reach
from melt.physics.phases import AIRBORNE, LIQUID
from melt.physics.search import axis_cell

FEW, WIDE = 10, 16  # columns and cells of a strip at most, unless one cell has more


@cpu_serial
def _near_box_packed(x, y, h, phase, start, stop, low_x, high_x, low_y, high_y, own, flood, found, count):
    """Do what `_near_box_portable` does, by AVX-512."""
    return append_near_box(x, y, h, phase, start, stop, low_x, high_x, low_y, high_y, own, flood.growth, found, count)


@cpu_serial
def _near_box_portable(x, y, h, phase, start, stop, low_x, high_x, low_y, high_y, own, flood, found, count):
    """Append the columns of water of [start, stop) that may be near one in the box to ``found``; return the new count."""
    real = type(own)
    slot = np.uint64(count)
    for k in range(np.uint64(start), np.uint64(stop)):
        # a difference that is NaN keeps the candidate
        dx = max(real(0), max(real(low_x - x[k]), real(x[k] - high_x)))
        dy = max(real(0), max(real(low_y - y[k]), real(y[k] - high_y)))
        near = squared_in_plane(dx, dy) < max(own, squared_reach(h[k], flood)) and phase[k] == LIQUID
        found[slot] = np.int32(k)
        slot += np.uint64(near)
    return np.int64(slot)


@cpu_serial
def _in_reach_packed(x, y, reach, number, stop, x_i, y_i, own, hit, found):
    """Do what `_in_reach_portable` does, by AVX-512."""
    return append_in_reach(x, y, reach, number, stop, x_i, y_i, own, found)


@cpu_serial
def _in_reach_portable(x, y, reach, number, stop, x_i, y_i, own, hit, found):
    """Write the numbers of the candidates below stop that are near to ``found``, return how many.

    A loop that the compiler vectorises marks the hits, another one appends without a branch.
    """
    real = type(own)
    for k in range(np.uint64(stop)):
        hit[k] = squared_in_plane(real(x_i - x[k]), real(y_i - y[k])) < max(own, reach[k])
    count = np.uint64(0)
    for k in range(np.uint64(stop)):
        found[count] = number[k]
        count += np.uint64(hit[k])
    return np.int64(count)


_near_box = _near_box_packed if AVAILABLE else _near_box_portable
_in_reach = _in_reach_packed if AVAILABLE else _in_reach_portable


@cpu_serial
def _strip(cell_start, cell_reach, c, stop_cell, nx):
    """Return the cell behind the strip that starts at cell c, and the rings to visit around it."""
    end, rings = c + 1, np.int64(cell_reach[c])
    limit = min(min(stop_cell, c + WIDE), (c // nx + 1) * nx)
    while end < limit and cell_start[end + 1] - cell_start[c] <= FEW:
        rings = max(rings, np.int64(cell_reach[end]))
        end += 1
    return end, rings


@cpu_serial
def _box(x, y, h, first, stop, flood):
    """Return the edges of the box around columns and the square of their largest reach; NaN is left out."""
    wide, real = x.dtype.type, h.dtype.type
    low_x, high_x, low_y, high_y, own = wide(np.inf), wide(-np.inf), wide(np.inf), wide(-np.inf), real(0)
    for i in range(np.uint64(first), np.uint64(stop)):
        low_x, high_x = (x[i] if x[i] < low_x else low_x), (x[i] if x[i] > high_x else high_x)
        low_y, high_y = (y[i] if y[i] < low_y else low_y), (y[i] if y[i] > high_y else high_y)
        own = max(own, squared_reach(h[i], flood))
    return low_x, high_x, low_y, high_y, own


@cpu_helper
def _buffers(size, x, h):
    """Return scratch for ``size`` candidates: numbers, coordinates, squared reaches, hit or not, hits."""
    room = size + 2 * LANES
    return (
        np.empty(room, np.int32), np.empty(room, x.dtype), np.empty(room, x.dtype), np.empty(room, h.dtype),
        np.empty(room, np.uint8), np.empty(room, np.int32),
    )


@cpu_serial
def _fill(x, y, h, flood, count, number, bx, by, reach):
    """Copy the candidates to the buffer and pad it with columns that are near nobody; return its length."""
    for s in range(np.uint64(count)):
        j = np.uint64(number[s])
        bx[s], by[s], reach[s] = x[j], y[j], squared_reach(h[j], flood)
    padded = (np.int64(count) + LANES - 1) // LANES * LANES
    for s in range(np.uint64(count), np.uint64(padded)):
        bx[s] = by[s] = np.inf
        reach[s] = reach.dtype.type(0)
    return padded


@cpu_serial
def _rows(cell_start, grid, c, end, rings, row):
    """Fill row with the ranges of columns in the rows of cells within reach of a strip; return their number and total."""
    nx = np.int64(grid.nx)
    c_y = c // nx
    first, last = max(c - c_y * nx - rings, 0), min(end - 1 - c_y * nx + rings, nx - 1)
    rows = total = 0
    for y in range(max(c_y - rings, 0), min(c_y + rings + 1, np.int64(grid.ny))):
        row[rows, 0], row[rows, 1] = cell_start[nx * y + first], cell_start[nx * y + last + 1]
        total += row[rows, 1] - row[rows, 0]
        rows += 1
    return rows, total


@cpu_serial
def _search(position, phase, h, cell_start, cell_reach, grid, flood, neighbour_count, neighbour_index, first_cell, stop_cell):
    x, y, nx = position[0], position[1], np.int64(grid.nx)
    capacity, size = neighbour_index.shape[1], 1024
    row = np.empty((np.int64(grid.ny), 2), np.int64)
    number, bx, by, reach, hit, found = _buffers(size, x, h)
    c = first_cell
    while c < stop_cell:
        if cell_start[c + 1] == cell_start[c]:
            c += 1
            continue
        end, rings = _strip(cell_start, cell_reach, c, stop_cell, nx)
        first, stop = np.int64(cell_start[c]), np.int64(cell_start[end])
        rows, total = _rows(cell_start, grid, c, end, rings, row)
        c = end
        if total > size:
            size = 2 * total
            number, bx, by, reach, hit, found = _buffers(size, x, h)
        low_x, high_x, low_y, high_y, most = _box(x, y, h, first, stop, flood)
        count = np.int64(0)
        for k in range(rows):
            count = _near_box(x, y, h, phase, row[k, 0], row[k, 1], low_x, high_x, low_y, high_y, most, flood, number, count)
        padded = _fill(x, y, h, flood, count, number, bx, by, reach)
        slot = np.int64(0)
        for i in range(first, stop):
            neighbour_count[i] = 0
            if phase[i] != LIQUID and phase[i] != AIRBORNE:
                continue
            while slot < count and number[slot] < i:
                slot += 1
            listed = slot < count and number[slot] == i
            if listed:
                bx[slot] = np.inf  # not its own neighbour
            near = _in_reach(bx, by, reach, number, padded, x[i], y[i], squared_reach(h[i], flood), hit, found)
            if listed:
                bx[slot] = x[i]
            neighbour_count[i] = near
            for k in range(np.uint64(min(near, capacity))):
                neighbour_index[i, k] = found[k]


@cpu_helper
def _first_cell(cell_start, particle, cells):
    """Return the first of ``cells`` cells that starts at or after a sorted particle."""
    low, high = 0, cells
    while low < high:
        middle = (low + high) // 2
        if cell_start[middle] < particle:
            low = middle + 1
        else:
            high = middle
    return low


@cpu_stage
def flood_neighbours(
    position, phase, support_radius, cell_start, cell_reach, grid, flood, neighbour_count, neighbour_index,
):
    """See `melt.reference.flood_neighbours.flood_neighbours`."""
    cells = np.int64(grid.nx) * grid.ny
    active = np.int64(cell_start[cells])
    for i in prange(active, phase.shape[0]):
        neighbour_count[i] = 0
    for chunk in prange(64):
        # 64 pieces of equally many columns, dealt out so that deep water and shallows are spread
        piece = (chunk * 37) % 64
        first = _first_cell(cell_start, active * piece // 64, cells)
        stop = _first_cell(cell_start, active * (piece + 1) // 64, cells)
        _search(
            position, phase, support_radius, cell_start, cell_reach, grid, flood, neighbour_count, neighbour_index, first, stop,
        )


@cpu_serial
def _beside(i, x_i, y_i, own, c_x, c_y, rings, boundary_position, boundary_start, grid, wall_index):
    """Write the boundary particles near a column, return their number."""
    real, capacity, count = type(own), wall_index.shape[1], np.int64(0)
    first_x, last_x = max(c_x - rings, 0), min(c_x + rings, grid.nx - 1)
    for y_cell in range(max(c_y - rings, 0), min(c_y + rings + 1, grid.ny)):
        row = grid.nx * y_cell
        for j in range(np.uint64(boundary_start[row + first_x]), np.uint64(boundary_start[row + last_x + 1])):
            x, y = real(x_i - boundary_position[0, j]), real(y_i - boundary_position[1, j])
            if squared_in_plane(x, y) < own:
                if count < capacity:
                    wall_index[i, count] = j
                count += 1
    return count


@cpu_stage
def wall_neighbours(
    position, phase, support_radius, boundary_position, boundary_start, boundary_ring, grid, flood, wall_count, wall_index,
):
    """See `melt.reference.flood_neighbours.wall_neighbours`."""
    for i in prange(wall_count.shape[0]):
        count = np.int64(0)
        if phase[i] == LIQUID:
            x_i, y_i, h = position[0, i], position[1, i], support_radius[i]
            c_x = axis_cell(x_i, grid.origin_x, grid.inverse_cell, grid.nx)
            c_y = axis_cell(y_i, grid.origin_y, grid.inverse_cell, grid.ny)
            rings = np.int64(outermost_ring(h, flood.growth, grid.inverse_cell, max(grid.nx, grid.ny)))
            if boundary_ring[c_x + grid.nx * c_y] <= rings:
                own = squared_reach(h, flood)
                count = _beside(i, x_i, y_i, own, c_x, c_y, rings, boundary_position, boundary_start, grid, wall_index)
        wall_count[i] = count
