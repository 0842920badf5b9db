"""Thinning of the ghost candidates of one cell, in integers: ghosts mark the points that they rule out."""

import numpy as np

from melt._compile import cpu_helper
from melt.physics.ghosts import (
    CANDIDATE,
    DROPPED,
    GHOST,
    UNITS,
    cell_order,
    cell_turn,
    gap_units,
    jitter_units,
    point_shift,
    squared_units,
)


@cpu_helper
def _lattice_range(u, reach, count):
    """Return the first and the last of 0 .. count-1 whose lattice points (half a pitch on) are within reach of u."""
    first = -((UNITS // 2 + reach - u) // UNITS)
    return max(first, np.int64(0)), min((u + reach - UNITS // 2) // UNITS, np.int64(count - 1))


@cpu_helper
def _rule_out(u_x, u_y, u_z, p_x, p_y, p_z, base, across, layers, reach, limit, ghost_state):
    """Drop the candidates of the cell that are too near to a ghost at (u_x, u_y, u_z).

    Units are kept in single precision, exact below 2^24: so are squares around the limit. A ghost looks through
    whole layers of points, in one long loop without branches.
    """
    i_0, i_1 = _lattice_range(u_x, reach, across)
    j_0, j_1 = _lattice_range(u_y, reach, layers)
    k_0, k_1 = _lattice_range(u_z, reach, across)
    if i_1 < i_0 or j_1 < j_0 or k_1 < k_0:
        return
    x, y, z, most = np.float32(u_x), np.float32(u_y), np.float32(u_z), np.float32(limit)
    shift = np.uint64(base)
    for p in range(np.uint64(k_0 * across * layers), np.uint64((k_1 + 1) * across * layers)):
        d_x, d_y, d_z = p_x[p] - x, p_y[p] - y, p_z[p] - z
        state = ghost_state[shift + p]
        drop = (state == np.int32(CANDIDATE)) & (d_x * d_x + d_y * d_y + d_z * d_z < most)
        ghost_state[shift + p] = np.int32(DROPPED) if drop else state


@cpu_helper
def _neighbour(cell, k, count, length):
    """Return (cell, seams crossed) of the cell k on along an axis; -1: none."""
    m = cell + k
    if 0 <= m < count:
        return m, np.int64(0)
    if not length > type(length)(0):
        return np.int64(-1), np.int64(0)
    return (m + count, np.int64(-1)) if m < 0 else (m - count, np.int64(1))


@cpu_helper
def _facing(o, reach, count):
    """Return the range of lattice numbers of the cell o on along an axis that can be within reach of this one."""
    deep = min((reach + 63) // UNITS + 1, count)
    return (count - deep if o < 0 else np.int64(0)), (deep if o > 0 else count)


@cpu_helper
def _any(ghost_state, base, size, value):
    found = np.int32(0)
    for q in range(np.uint64(base), np.uint64(base + size)):
        found += np.int32(1) if ghost_state[q] == value else np.int32(0)
    return found > 0


@cpu_helper
def _thin_cell(ghost_state, c_x, c_y, c_z, grid, period, ghosts, p_x, p_y, p_z):
    """Take the candidates of a cell that the ghosts around it leave, one after the other."""
    across = np.int64(ghosts.across)
    layers = np.int64(1) if ghosts.flat else across
    size = across * layers * across
    base = (c_x + np.int64(grid.nx) * (c_y + np.int64(grid.ny) * c_z)) * size
    if not _any(ghost_state, base, size, CANDIDATE):
        return
    limit = squared_units(ghosts)
    reach = np.int64(np.sqrt(np.float64(limit))) + np.int64(1) + jitter_units(ghosts)
    gap_x, gap_y = gap_units(period.length_x, grid.nx, ghosts), gap_units(period.length_y, grid.ny, ghosts)
    gap_z = gap_units(period.length_z, grid.nz, ghosts)
    edge, half = across * UNITS, np.int64(UNITS // 2)
    p = np.uint64(0)
    for k in range(across):
        for j in range(layers):
            for i in range(across):
                if ghost_state[np.uint64(base) + p] == CANDIDATE:
                    x, y, z = point_shift(np.uint64(base) + p, ghosts)
                    p_x[p], p_y[p], p_z[p] = i * UNITS + half + x, j * UNITS + half + y, k * UNITS + half + z
                p += np.uint64(1)
    for n in range(27):
        m_x, seam_x = _neighbour(c_x, n % 3 - 1, grid.nx, period.length_x)
        m_y, seam_y = _neighbour(c_y, n // 3 % 3 - 1, grid.ny, period.length_y)
        m_z, seam_z = _neighbour(c_z, n // 9 - 1, grid.nz, period.length_z)
        if m_x < 0 or m_y < 0 or m_z < 0 or (ghosts.flat and m_y != c_y):
            continue
        other = (m_x + np.int64(grid.nx) * (m_y + np.int64(grid.ny) * m_z)) * size
        if not _any(ghost_state, other, size, GHOST):
            continue
        o_x = (n % 3 - 1) * edge + seam_x * gap_x + half
        o_y = (n // 3 % 3 - 1) * layers * UNITS + seam_y * gap_y + half
        o_z = (n // 9 - 1) * edge + seam_z * gap_z + half
        i_0, i_1 = _facing(n % 3 - 1, reach, across)
        j_0, j_1 = _facing(n // 3 % 3 - 1, reach, layers)
        k_0, k_1 = _facing(n // 9 - 1, reach, across)
        for k in range(k_0, k_1):
            for j in range(j_0, j_1):
                line = other + across * (j + layers * k)
                for q in range(np.uint64(line + i_0), np.uint64(line + i_1)):
                    if ghost_state[q] == GHOST:
                        x, y, z = point_shift(q, ghosts)
                        x += o_x + (np.int64(q) - line) * UNITS
                        y += o_y + j * UNITS
                        z += o_z + k * UNITS
                        _rule_out(x, y, z, p_x, p_y, p_z, base, across, layers, reach, limit, ghost_state)
    p, stride = cell_order(c_x + grid.nx * (c_y + grid.ny * c_z), size, across, ghosts)
    for _ in range(size):
        p += stride
        p -= size if p >= size else 0
        if ghost_state[base + p] == CANDIDATE:
            ghost_state[base + p] = GHOST
            _rule_out(
                np.int64(p_x[p]), np.int64(p_y[p]), np.int64(p_z[p]), p_x, p_y, p_z, base, across, layers, reach,
                limit, ghost_state,
            )


@cpu_helper
def thin_rows(ghost_state, grid, period, ghosts, t_x, t_y, t_z, piece, pieces):
    """Thin a share of the cells of a turn."""
    size = np.int64(ghosts.across) * ghosts.across * (1 if ghosts.flat else ghosts.across)
    p_x, p_y, p_z = np.empty(size, np.float32), np.empty(size, np.float32), np.empty(size, np.float32)
    lines = np.int64(grid.ny) * grid.nz
    for line in range(lines * piece // pieces, lines * (piece + 1) // pieces):
        c_y, c_z = line % grid.ny, line // grid.ny
        if cell_turn(c_y, grid.ny, period.length_y) != t_y or cell_turn(c_z, grid.nz, period.length_z) != t_z:
            continue
        for c_x in range(np.int64(grid.nx)):
            if cell_turn(c_x, grid.nx, period.length_x) == t_x:
                _thin_cell(ghost_state, c_x, c_y, c_z, grid, period, ghosts, p_x, p_y, p_z)
