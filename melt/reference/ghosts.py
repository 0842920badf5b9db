r"""Air ghost particles: candidates, thinning, list. Slime spec 2.8.

Candidates stand on a lattice of `across` points per edge of a cell of the neighbour grid, each shifted by a
jitter that is a hash of its number (in steps of 1/128 of the pitch, less than half a pitch). Point
ix + across (iy + across iz) of cell c has number c across^3 plus that; in two dimensions (`flat`) a cell has
across^2 points ix + across iz, in the plane of the liquid.

Of the candidates a maximal set is kept whose members are no nearer to each other than `distance`: they are
taken in an order that is a hash, too. The spec thins in rounds by random priorities (Luby 1986); this order
comes from cells in eight turns instead: one pass, no loop on the host, and as much freedom from the lattice.

A periodic axis begins at the origin of the grid, and has at least two cells; where they do not fill it, the
strip behind the last one has no points (choose the edge so that they do).
"""

import numpy as np

from melt.reference._ghosts import UNITS, apart, cell_points, positions, units, words
from melt.reference._pairs import W

LOT = 2048  # points at a time


def _cells(grid):
    return int(grid.nx) * int(grid.ny) * int(grid.nz)


def _layer(grid, ghosts):
    """Return the layer of cells along y that holds the plane of two dimensions."""
    t = (float(ghosts.plane) - float(grid.origin_y)) * float(grid.inverse_cell)
    return int(np.clip(np.floor(t), 0, int(grid.ny) - 1))


def _inside(x, period):
    """Return which points (3, m) lie in the periodic box."""
    inside = np.ones(x.shape[1], dtype=bool)
    axes = (
        (period.lower_x, period.length_x), (period.lower_y, period.length_y), (period.lower_z, period.length_z)
    )
    for a, (lower, length) in enumerate(axes):
        if length > 0:
            inside &= (x[a] >= float(lower)) & (x[a] < float(lower) + float(length))
    return inside


def ghost_candidates(position, phase, volume, cell_start, grid, smoothing, period, ghosts, ghost_state):
    r"""Write which lattice points are candidates: 1, others 0.

    A candidate (i) has its nearest node at a distance in [distance, h), (ii) has no wall, driven or solid
    particle nearer than distance, (iii) stands in air: fill = sum V_j W(r) over nodes below `fill`. Nodes
    are liquid particles with volume > 0.

    Reads: position (3, n) [m], phase (n,), volume (n,) [m^3]; cell_start is not used (all pairs).
    Writes: ghost_state (points,).
    """
    V = volume.astype(np.float64)
    node, solid = (phase == 0) & (V > 0), (phase != 0) & (phase != 5)
    d2, h2 = float(ghosts.distance) ** 2, float(smoothing.support) ** 2
    for first in range(0, _cells(grid) * cell_points(ghosts), LOT):
        q = np.arange(first, min(first + LOT, _cells(grid) * cell_points(ghosts)))
        x = positions(q, grid, ghosts)
        r2 = apart(x, position[:, node], period)
        nearest = r2.min(axis=1, initial=np.inf)
        fill = (V[node] * W(np.sqrt(r2), smoothing)).sum(axis=1)
        wall = apart(x, position[:, solid], period).min(axis=1, initial=np.inf)
        keep = (nearest >= d2) & (nearest < h2) & (wall >= d2) & (fill < float(ghosts.fill)) & _inside(x, period)
        if ghosts.flat:
            keep &= q // cell_points(ghosts) // int(grid.nx) % int(grid.ny) == _layer(grid, ghosts)
        ghost_state[q] = np.where(keep, 1, 0)


def _turns(candidate, grid, period, ghosts):
    """Return the candidates in the order in which they are taken."""
    a, size = int(ghosts.across), cell_points(ghosts)
    c, p = np.divmod(candidate, size)
    counts = int(grid.nx), int(grid.ny), int(grid.nz)
    turn = np.zeros(candidate.size, dtype=np.int64)
    cells = c % counts[0], c // counts[0] % counts[1], c // (counts[0] * counts[1])
    lengths = period.length_x, period.length_y, period.length_z
    for axis in range(3):
        last = (cells[axis] == counts[axis] - 1) & (lengths[axis] > 0) & (counts[axis] % 2 == 1)
        turn += 3**axis * np.where(last, 2, cells[axis] % 2)
    word = words(c, 1, ghosts)
    start = (word & np.uint64(2**31 - 1)).astype(np.int64) % size
    stride = (word >> np.uint64(32) & np.uint64(2**31 - 1)).astype(np.int64) % size * a + 1  # none divides size
    place = np.empty(candidate.size, dtype=np.int64)
    for k in range(size):  # the k-th point that a cell takes
        place[(start + (k + 1) * stride) % size == p] = k
    return candidate[np.lexsort((place, c, turn))]


def ghost_thin(grid, period, ghosts, ghost_state):
    """Write which candidates become ghosts: 2, and which are dropped: 3.

    Candidates are taken one after the other; one becomes a ghost unless a ghost is nearer than `distance`.
    Their order: cells by their turn (even and odd along x, y, z; the last of an odd number of cells along a
    periodic axis has a turn of its own), so that cells of one turn do not see each other; in a cell
    start + stride, start + 2 stride, ... modulo its points, both by the hash of the cell. Distances are
    compared in integers, the length of a periodic axis is rounded to 1/128 of the pitch.

    Reads and writes: ghost_state (points,).
    """
    total = _cells(grid) * cell_points(ghosts)
    limit = int(np.ceil((float(ghosts.distance) / float(ghosts.pitch) * UNITS) ** 2))
    lengths = [
        round(float(a) / float(ghosts.pitch) * UNITS) for a in (period.length_x, period.length_y, period.length_z)
    ]
    old = np.flatnonzero(ghost_state[:total] == 2)
    order = _turns(np.flatnonzero(ghost_state[:total] == 1), grid, period, ghosts)
    u = units(np.concatenate([old, order]), grid, ghosts)
    ghost = np.arange(u.shape[1]) < old.size
    for m, q in enumerate(order):
        d = u[:, ghost] - u[:, old.size + m, None]
        for a, length in enumerate(lengths):
            if length:
                d[a] -= length * np.floor(d[a] / length + 0.5).astype(np.int64)
        near = ((d**2).sum(axis=0) < limit).any()
        ghost[old.size + m] = not near
        ghost_state[q] = 3 if near else 2


def ghost_list(ghost_state, grid, ghosts, ghost_start, chunk_sum):
    """Write the number of ghosts in the cells before each cell.

    Reads: ghost_state (points,).
    Writes: ghost_start (cells + 2,): ghosts of cell c have the numbers ghost_start[c] to ghost_start[c + 1];
        the last two entries are their total number.
    """
    cells = _cells(grid)
    count = (ghost_state[: cells * cell_points(ghosts)] == 2).reshape(cells, -1).sum(axis=1)
    ghost_start[: cells + 1] = np.concatenate([[0], np.cumsum(count)])
    ghost_start[cells + 1] = ghost_start[cells]


def ghost_place(ghost_state, ghost_start, grid, ghosts, ghost_position):
    """Write the positions of ghosts in the order of their lattice numbers, as many as there is room for.

    Reads: ghost_state (points,), ghost_start (cells + 2,). Writes: ghost_position (3, capacity) [m].
    """
    q = np.flatnonzero(ghost_state[: _cells(grid) * cell_points(ghosts)] == 2)[: ghost_position.shape[1]]
    ghost_position[:, : q.size] = positions(q, grid, ghosts)
