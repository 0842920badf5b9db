"""Separations in a periodic box. Slime spec 1."""

import numpy as np


def wrapped(d, period):
    """Return separations d (3, k) taken to the nearest image along each periodic axis."""
    length = np.array([period.length_x, period.length_y, period.length_z], float)[:, None]
    inverse = np.array([period.inverse_x, period.inverse_y, period.inverse_z], float)[:, None]
    return d - length * np.floor(d * inverse + 0.5)
