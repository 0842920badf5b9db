"""Lattice of ghost candidates, its hash, and the order of thinning. Slime spec 2.8, 3.

Places on the lattice are counted in 1/128 of its pitch, as integers: which points are closer than a distance
never depends on rounding, and all backends thin the same way. A point's jitter and turn are
functions of its number and the seed alone.
"""

import math

import numpy as np

from melt._compile import scalar, scalar_lookup

UNITS = 128  # in a pitch
NONE, CANDIDATE, GHOST, DROPPED = range(4)  # values of ghost_state


@scalar
def mixed(c0):
    """Return splitmix64's finaliser of a word of 64 bits."""
    c0 = (c0 ^ (c0 >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    c0 = (c0 ^ (c0 >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return c0 ^ (c0 >> np.uint64(31))


@scalar
def point_word(id, number, seed_low, seed_high):
    """Return draw ``number`` (0 jitter of a point, 1 order of a cell), 64 bits; seeds are int32 bit patterns."""
    low = np.uint64(0xFFFFFFFF)
    key = ((np.uint64(seed_high) & low) << np.uint64(32)) | (np.uint64(seed_low) & low)
    place = np.uint64(2) * np.uint64(id) + np.uint64(number) + np.uint64(1)
    return mixed(mixed(key) + place * np.uint64(0x9E3779B97F4A7C15))


@scalar
def jitter_units(ghosts):
    """Return the largest shift in units; below half a pitch, so that a point stays in its cell."""
    real = type(ghosts.pitch)
    return min(np.int64(math.floor(ghosts.jitter / ghosts.pitch * real(UNITS) + real(0.5))), np.int64(63))


@scalar
def squared_units(ghosts):
    """Return the integer n with: closer than ``distance`` if the squared units are below n."""
    real = type(ghosts.pitch)
    t = ghosts.distance / ghosts.pitch * real(UNITS)
    return np.int64(math.ceil(t * t))


@scalar
def gap_units(length, count, ghosts):
    """Return how much farther lattice points on both sides of a periodic box's seam are than others, in units."""
    real = type(ghosts.pitch)
    if not length > real(0):
        return np.int64(0)
    whole = np.int64(math.floor(length / ghosts.pitch * real(UNITS) + real(0.5)))
    return whole - np.int64(count) * np.int64(ghosts.across) * np.int64(UNITS)


@scalar
def point_shift(id, ghosts):
    """Return a point's jitter along x, y, z in units, uniform on -K..K; none along y in two dimensions."""
    word = point_word(id, 0, ghosts.seed_low, ghosts.seed_high)
    most = jitter_units(ghosts)
    width, part, bits = np.uint64(2 * most + 1), np.uint64(0x1FFFFF), np.uint64(21)
    x = np.int64(((word & part) * width) >> bits) - most
    y = np.int64((((word >> bits) & part) * width) >> bits) - most
    z = np.int64((((word >> np.uint64(42)) & part) * width) >> bits) - most
    return x, np.int64(0) if ghosts.flat else y, z


@scalar
def point_coordinate(i, shift, origin, pitch, like):
    """Return the coordinate of lattice number i, half a pitch and ``shift`` units on, in the type of ``like`` [m]."""
    wide = type(like)
    units = np.int64(i) * np.int64(UNITS) + np.int64(UNITS // 2) + np.int64(shift)
    return wide(origin) + wide(units) * (wide(pitch) * wide(1 / UNITS))


@scalar
def in_box(x, lower, length):
    """Return whether x lies in the periodic box; True for length 0."""
    wide = type(x)
    return not length > type(length)(0) or (x >= wide(lower) and x < wide(lower) + wide(length))


@scalar
def moved_point(cell, row, k, count, across, length):
    """Return (cell, point within it, seams crossed) k lattice points on along one axis; cell -1: outside."""
    row = np.int64(row) + np.int64(k)
    cell, seams = np.int64(cell), np.int64(0)
    while row < 0:
        row += across
        cell -= 1
    while row >= across:
        row -= across
        cell += 1
    if length > type(length)(0):
        while cell < 0:
            cell += count
            seams -= 1
        while cell >= count:
            cell -= count
            seams += 1
    return cell if 0 <= cell < count else np.int64(-1), row, seams


@scalar
def least_square(k, width):
    """Return the smallest squared distance along an axis of points k apart, both shifted by up to ``width`` units."""
    apart = max(abs(np.int64(k)) * np.int64(UNITS) - np.int64(2) * width, np.int64(0))
    return apart * apart


@scalar
def cell_turn(cell, count, length):
    """Return when a cell's turn comes along one axis: neighbours, those across a seam too, never have the same."""
    return 2 if length > type(length)(0) and count % 2 and cell == count - 1 else cell % 2


@scalar
def cell_order(id, count, across, ghosts):
    """Return (start, stride) of the order in which cell ``id`` takes its points; no stride divides ``count``."""
    word = point_word(id, 1, ghosts.seed_low, ghosts.seed_high)
    part = np.uint64(0x7FFFFFFF)
    start, rows = np.int64(word & part) % count, np.int64((word >> np.uint64(32)) & part) % count
    return start, (rows * across + 1) % count if count > 1 else np.int64(0)


@scalar_lookup
def ghost_near(ghost_state, id, grid, period, ghosts):
    """Return whether a ghost is nearer than the distance to the point ``id``."""
    across = np.int64(ghosts.across)
    layers = np.int64(1) if ghosts.flat else across
    size = across * layers * across
    c, p = id // size, id % size
    i, j, k = p % across, p // across % layers, p // (across * layers)
    c_x, c_y, c_z = c % grid.nx, c // grid.nx % grid.ny, c // (np.int64(grid.nx) * grid.ny)
    most, limit = jitter_units(ghosts), squared_units(ghosts)
    gap_x, gap_y = gap_units(period.length_x, grid.nx, ghosts), gap_units(period.length_y, grid.ny, ghosts)
    gap_z = gap_units(period.length_z, grid.nz, ghosts)
    x, y, z = point_shift(id, ghosts)
    reach = np.int64(0)
    while least_square(reach + 1, most) < limit:
        reach += 1
    for o_z in range(-reach, reach + 1):
        m_z, k_z, seam_z = moved_point(c_z, k, o_z, grid.nz, across, period.length_z)
        for o_y in range(0 if ghosts.flat else -reach, 1 if ghosts.flat else reach + 1):
            m_y, k_y, seam_y = moved_point(c_y, j, o_y, grid.ny, layers, period.length_y)
            if m_y < 0 or m_z < 0 or least_square(o_z, most) + least_square(o_y, most) >= limit:
                continue
            for o_x in range(-reach, reach + 1):
                m_x, k_x, seam_x = moved_point(c_x, i, o_x, grid.nx, across, period.length_x)
                if m_x < 0:
                    continue
                q = (m_x + grid.nx * (m_y + grid.ny * m_z)) * size + k_x + across * (k_y + layers * k_z)
                if q == id or ghost_state[q] != GHOST:
                    continue
                x_q, y_q, z_q = point_shift(q, ghosts)
                d_x = o_x * UNITS + seam_x * gap_x + x_q - x
                d_y = o_y * UNITS + seam_y * gap_y + y_q - y
                d_z = o_z * UNITS + seam_z * gap_z + z_q - z
                if d_x * d_x + d_y * d_y + d_z * d_z < limit:
                    return True
    return False


@scalar
def image(x, middle, length, inverse):
    """Return the image of x in a periodic box that is nearest to the middle of a cell; x itself for length 0."""
    wide = type(x)
    if not length > type(length)(0):
        return x
    return x - wide(length) * wide(math.floor((x - middle) * wide(inverse) + wide(0.5)))
