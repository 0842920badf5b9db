"""Distances between points of a periodic box: float64, axis by axis."""

import numpy as np


def lengths(period):
    """Return the lengths of the periodic axes [m], 0 for the others, and where the box begins."""
    length = np.array([period.length_x, period.length_y, period.length_z], dtype=np.float64)
    return length, np.array([period.lower_x, period.lower_y, period.lower_z], dtype=np.float64)


def nearest(d, period):
    """Return differences d (3, ...) taken to the nearest image, at most L/2 long along a periodic axis."""
    length, _ = lengths(period)
    found = np.array(d, dtype=np.float64)
    for a in np.flatnonzero(length):
        found[a] -= length[a] * np.rint(found[a] / length[a])
    return found


def boxed(x, period):
    """Return positions x (3, n), moved by whole lengths into the box along periodic axes."""
    length, lower = lengths(period)
    found = np.array(x, dtype=np.float64)
    for a in np.flatnonzero(length):
        found[a] -= length[a] * np.floor((found[a] - lower[a]) / length[a])
    return found
