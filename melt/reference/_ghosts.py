"""Lattice points of ghost candidates by NumPy: numbers, jitter, priority, positions. Slime spec 2.8."""

import numpy as np

UNITS = 128


def _mixed(z):
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def words(number, draw, ghosts):
    """Return 64 random bits per point: splitmix64's stream of the seed, entry 2 number + draw."""
    key = np.array([(int(ghosts.seed_high) % 2**32) << 32 | int(ghosts.seed_low) % 2**32], dtype=np.uint64)
    place = np.uint64(2) * number.astype(np.uint64) + np.uint64(draw + 1)
    return _mixed(_mixed(key) + place * np.uint64(0x9E3779B97F4A7C15))


def cell_points(ghosts):
    """Return the number of points of a cell."""
    return int(ghosts.across) ** (2 if ghosts.flat else 3)


def units(number, grid, ghosts):
    """Return the places (3, points) of lattice points, jitter included, in 1/128 of the pitch from the origin."""
    a, layers = int(ghosts.across), 1 if ghosts.flat else int(ghosts.across)
    number = np.asarray(number, dtype=np.int64)
    c, p = np.divmod(number, cell_points(ghosts))
    nx, ny = int(grid.nx), int(grid.ny)
    lattice = np.stack(
        [c % nx * a + p % a, c // nx % ny * layers + p // a % layers, c // (nx * ny) * a + p // (a * layers)]
    )
    most = min(int(np.floor(float(ghosts.jitter) / float(ghosts.pitch) * UNITS + 0.5)), 63)
    word = words(number, 0, ghosts)
    parts = np.stack([word >> np.uint64(21 * axis) & np.uint64(2**21 - 1) for axis in range(3)]).astype(np.int64)
    shift = (parts * (2 * most + 1) >> 21) - most
    if ghosts.flat:
        shift[1] = 0
    return lattice * UNITS + UNITS // 2 + shift


def positions(number, grid, ghosts):
    """Return the positions (3, points) of lattice points [m]."""
    origin = np.array([[grid.origin_x], [grid.origin_y], [grid.origin_z]], dtype=np.float64)
    x = origin + units(number, grid, ghosts) * (float(ghosts.pitch) / UNITS)
    if ghosts.flat:
        x[1] = float(ghosts.plane)
    return x


def nearest_image(d, period):
    """Return differences (3, ...) taken to the nearest image of the periodic box."""
    d = d.copy()
    for a, length in enumerate((period.length_x, period.length_y, period.length_z)):
        if length > 0:
            d[a] -= float(length) * np.floor(d[a] / float(length) + 0.5)
    return d


def apart(x, y, period):
    """Return squared distances (points of x, points of y) [m^2]."""
    d = nearest_image(x[:, :, None] - np.asarray(y, dtype=np.float64)[:, None, :], period)
    return (d**2).sum(axis=0)
