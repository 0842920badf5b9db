"""Sum of the smoothing function over the lattice of rest, in two dimensions. Flood spec 0."""

from functools import lru_cache

import numpy as np


@lru_cache
def normalisation(kernel, ratio, lattice="square"):
    """Return sigma = 1/(1 + beta_lat): what makes Sum W A = 1 on a lattice with a support of ``ratio`` spacings.

    The spacing of a hexagonal lattice is that of a square one with as many points per area.
    """
    reach = int(np.ceil(ratio)) + 2
    i, j = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1))
    if lattice == "hexagonal":
        edge = np.sqrt(2 / np.sqrt(3))
        x, y = edge * (i + 0.5 * j), edge * np.sqrt(3) / 2 * j
        far = np.hypot(x, y)
    else:
        far = np.hypot(i, j)
    q = far / (0.5 * ratio)  # r/l
    if kernel == "wendland2":
        values = 7 / (4 * np.pi) * np.clip(1 - 0.5 * q, 0, None) ** 4 * (1 + 2 * q)
    else:
        inner = 1 - 1.5 * q**2 + 0.75 * q**3
        values = 10 / (7 * np.pi) * np.where(q < 1, inner, 0.25 * np.clip(2 - q, 0, None) ** 3)
    return float(1.0 / (values.sum() / (0.5 * ratio) ** 2))
