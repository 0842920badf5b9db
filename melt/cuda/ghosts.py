"""CUDA twin of `melt.reference.ghosts`: a thread for each lattice point."""

import math

from melt._compile import cuda, cuda_kernel
from melt.cuda._scan import inclusive_scan
from melt.physics.ghosts import (
    CANDIDATE,
    DROPPED,
    GHOST,
    NONE,
    UNITS,
    cell_order,
    cell_turn,
    ghost_near,
    in_box,
    point_coordinate,
    point_shift,
    squared_units,
)
from melt.physics.period import near_cell, wrap
from melt.physics.phases import LIQUID
from melt.physics.search import axis_cell
from melt.physics.smoothing import W


def _points(grid, ghosts):
    """Return the number of points of a cell, and of all cells."""
    size = int(ghosts.across) ** (2 if ghosts.flat else 3)
    return size, size * int(grid.nx) * int(grid.ny) * int(grid.nz)


@cuda_kernel
def _ghost_candidates(position, phase, volume, cell_start, points, grid, smoothing, period, ghosts, ghost_state):
    q = cuda.grid(1)
    if q >= points:
        return
    real = type(smoothing.support)
    like = position.dtype.type(0)
    across = ghosts.across
    layers = 1 if ghosts.flat else across
    size = across * layers * across
    c, p = q // size, q % size
    c_x, c_y, c_z = c % grid.nx, c // grid.nx % grid.ny, c // (grid.nx * grid.ny)
    ghost_state[q] = NONE
    s_x, s_y, s_z = point_shift(q, ghosts)
    x_q = point_coordinate(c_x * across + p % across, s_x, grid.origin_x, ghosts.pitch, like)
    y_q = point_coordinate(c_y * across + p // across % layers, s_y, grid.origin_y, ghosts.pitch, like)
    z_q = point_coordinate(c_z * across + p // (across * layers), s_z, grid.origin_z, ghosts.pitch, like)
    if ghosts.flat:
        y_q = type(like)(ghosts.plane)
        if c_y != axis_cell(y_q, grid.origin_y, grid.inverse_cell, grid.ny):
            return
    if not in_box(x_q, period.lower_x, period.length_x) or not in_box(y_q, period.lower_y, period.length_y):
        return
    if not in_box(z_q, period.lower_z, period.length_z):
        return
    d2, h2 = ghosts.distance * ghosts.distance, smoothing.support * smoothing.support
    near, fill = 0, real(0)
    for n in range(27):
        m_x = near_cell(c_x, n % 3, grid.nx, period.length_x)
        m_y = near_cell(c_y, n // 3 % 3, grid.ny, period.length_y)
        m_z = near_cell(c_z, n // 9, grid.nz, period.length_z)
        if m_x < 0 or m_y < 0 or m_z < 0:
            continue
        m = m_x + grid.nx * (m_y + grid.ny * m_z)
        for j in range(cell_start[m], cell_start[m + 1]):
            if phase[j] == LIQUID and not volume[j] > real(0):
                continue
            x = real(wrap(x_q - position[0, j], period.length_x, period.inverse_x))
            y = real(wrap(y_q - position[1, j], period.length_y, period.inverse_y))
            z = real(wrap(z_q - position[2, j], period.length_z, period.inverse_z))
            r2 = x * x + y * y + z * z
            if r2 < d2:
                return
            if phase[j] == LIQUID and r2 < h2:
                near += 1
                fill += volume[j] * W(math.sqrt(r2), smoothing)
    if near > 0 and fill < ghosts.fill:
        ghost_state[q] = CANDIDATE


def ghost_candidates(position, phase, volume, cell_start, grid, smoothing, period, ghosts, ghost_state):
    """See `melt.reference.ghosts.ghost_candidates`."""
    points = _points(grid, ghosts)[1]
    _ghost_candidates.launch(
        points, position, phase, volume, cell_start, points, grid, smoothing, period, ghosts, ghost_state
    )


@cuda_kernel
def _drop(points, size, turn, grid, period, ghosts, ghost_state):
    """Drop candidates of the cells whose turn it is that are too near to ghosts of earlier turns."""
    q = cuda.grid(1)
    if q >= points or ghost_state[q] != CANDIDATE:
        return
    c = q // size
    if cell_turn(c % grid.nx, grid.nx, period.length_x) != turn % 3:
        return
    if cell_turn(c // grid.nx % grid.ny, grid.ny, period.length_y) != turn // 3 % 3:
        return
    if cell_turn(c // (grid.nx * grid.ny), grid.nz, period.length_z) != turn // 9:
        return
    if ghost_near(ghost_state, q, grid, period, ghosts):
        ghost_state[q] = DROPPED


@cuda_kernel
def _take(cells, size, turn, grid, period, ghosts, ghost_state):
    """Take the candidates that are left in a cell one after the other; only those of the cell see each other."""
    c = cuda.grid(1)
    if c >= cells or cell_turn(c % grid.nx, grid.nx, period.length_x) != turn % 3:
        return
    if cell_turn(c // grid.nx % grid.ny, grid.ny, period.length_y) != turn // 3 % 3:
        return
    if cell_turn(c // (grid.nx * grid.ny), grid.nz, period.length_z) != turn // 9:
        return
    across = ghosts.across
    layers = 1 if ghosts.flat else across
    limit = squared_units(ghosts)
    p, stride = cell_order(c, size, across, ghosts)
    for _ in range(size):
        p = (p + stride) % size
        q = c * size + p
        if ghost_state[q] != CANDIDATE:
            continue
        ghost_state[q] = GHOST
        s_x, s_y, s_z = point_shift(q, ghosts)
        i, j, k = p % across, p // across % layers, p // (across * layers)
        for o in range(size):
            if ghost_state[c * size + o] != CANDIDATE:
                continue
            x, y, z = point_shift(c * size + o, ghosts)
            x += (o % across - i) * UNITS - s_x
            y += (o // across % layers - j) * UNITS - s_y
            z += (o // (across * layers) - k) * UNITS - s_z
            if x * x + y * y + z * z < limit:
                ghost_state[c * size + o] = DROPPED


def ghost_thin(grid, period, ghosts, ghost_state):
    """See `melt.reference.ghosts.ghost_thin`. Cells in up to 27 turns, two launches each."""
    size, points = _points(grid, ghosts)
    axes = [
        3 if length > 0 and count % 2 else 2
        for count, length in (
            (int(grid.nx), period.length_x), (int(grid.ny), period.length_y), (int(grid.nz), period.length_z),
        )
    ]
    for turn in range(27):
        if turn % 3 < axes[0] and turn // 3 % 3 < axes[1] and turn // 9 < axes[2]:
            _drop.launch(points, points, size, turn, grid, period, ghosts, ghost_state)
            _take.launch(points // size, points // size, size, turn, grid, period, ghosts, ghost_state)


@cuda_kernel
def _clear(values):
    k = cuda.grid(1)
    if k < values.shape[0]:
        values[k] = 0


@cuda_kernel
def _count(ghost_state, points, size, ghost_start):
    q = cuda.grid(1)
    if q < points and ghost_state[q] == GHOST:
        cuda.atomic.add(ghost_start, q // size + 1, 1)


def ghost_list(ghost_state, grid, ghosts, ghost_start, chunk_sum):
    """See `melt.reference.ghosts.ghost_list`."""
    size, points = _points(grid, ghosts)
    _clear.launch(ghost_start.shape[0], ghost_start)
    _count.launch(points, ghost_state, points, size, ghost_start)
    inclusive_scan(ghost_start, chunk_sum)


@cuda_kernel
def _ghost_place(ghost_state, ghost_start, cells, grid, ghosts, ghost_position):
    c = cuda.grid(1)
    if c >= cells or ghost_start[c] == ghost_start[c + 1]:
        return
    like = ghost_position.dtype.type(0)
    across = ghosts.across
    layers = 1 if ghosts.flat else across
    size = across * layers * across
    c_x, c_y, c_z = c % grid.nx, c // grid.nx % grid.ny, c // (grid.nx * grid.ny)
    slot = ghost_start[c]
    for p in range(size):
        if ghost_state[c * size + p] != GHOST or slot >= ghost_position.shape[1]:
            continue
        x, y, z = point_shift(c * size + p, ghosts)
        i, j, k = p % across, p // across % layers, p // (across * layers)
        ghost_position[0, slot] = point_coordinate(c_x * across + i, x, grid.origin_x, ghosts.pitch, like)
        y_g = point_coordinate(c_y * across + j, y, grid.origin_y, ghosts.pitch, like)
        ghost_position[1, slot] = ghosts.plane if ghosts.flat else y_g
        ghost_position[2, slot] = point_coordinate(c_z * across + k, z, grid.origin_z, ghosts.pitch, like)
        slot += 1


def ghost_place(ghost_state, ghost_start, grid, ghosts, ghost_position):
    """See `melt.reference.ghosts.ghost_place`."""
    cells = int(grid.nx) * int(grid.ny) * int(grid.nz)
    _ghost_place.launch(cells, ghost_state, ghost_start, cells, grid, ghosts, ghost_position)
