"""Shifts columns until they are as dense as they should be: static, without time, mass or pressure."""

import numpy as np
from scipy.spatial import cKDTree

#: Neighbours of a column in its list, and which of them gives the reach: the 12th is two spacings away.
LISTED, REACH = 14, 12
#: Sweeps between two lists, gain of a shift, largest shift of a sweep in spacings.
KEPT, GAIN, LONGEST = 4, 0.6, 0.25
#: Columns handled at a time, so that what is reckoned of their pairs stays in the cache.
BLOCK = 2048


def relax_columns(x, raster, share, lower, upper, sweeps):
    """Return places (2, n) moved towards an even filling of ``share`` (ny, nx), the cells of ``raster``.

    Each column is pushed off by its neighbours and drawn by the water around it, both with the slope of
    (1 - r/R)^3: at rest the columns have the density of the water, next to a wall or shore too, since water
    that is not there does not draw. (The kernel is positive definite: the push has no pairs at zero distance.)
    A shift that would leave the water or the box is not made.
    """
    n = x.shape[1]
    if n < 2 or sweeps == 0:
        return x
    density = raster.fields(share * (n / (share.sum() * raster.cell.prod())))  # columns per m^2
    k = min(LISTED + 1, n)
    for sweep in range(sweeps):
        if sweep % KEPT == 0:
            far, near = cKDTree(x.T).query(x.T, k=k)
            reach = far[:, min(REACH, k - 1)] * (1 + 1e-9)
            near = near[:, 1:]
            pull = _pull(x, reach, density)
        force = _push(x, near, reach) - pull
        shift = GAIN * 0.5 * reach * force * min(1.0, 2.0 * (sweeps - sweep) / sweeps)
        length = np.hypot(*shift)
        shift *= np.minimum(1.0, LONGEST * 0.5 * reach / np.maximum(length, 1e-300))
        new = np.clip(x + shift, lower[:, None], upper[:, None])
        x = np.where(raster.at(*new) > 0, new, x)
    return x


def _push(x, near, reach):
    """Return the sum of (1 - r/R)^2 along the pairs (2, n)."""
    total = np.empty_like(x)
    for first in range(0, x.shape[1], BLOCK):
        some = slice(first, first + BLOCK)
        a, b = (x[k, some, None] - x[k][near[some]] for k in (0, 1))
        r = np.sqrt(a * a + b * b)
        np.maximum(r, 1e-12 * reach[some, None], out=r)
        push = np.maximum(1 - r / reach[some, None], 0.0)
        push *= push / r
        total[0, some], total[1, some] = np.einsum("nk,nk->n", push, a), np.einsum("nk,nk->n", push, b)
    return total


def _pull(x, reach, density, rings=4, spokes=12):
    """Return what the water around pushes (2, n) if it were columns: int density (1 - s/R)^2 s/|s| ds."""
    radius = (np.arange(rings) + 0.5) / rings
    # midpoint rule in the radius: ring area 2 pi r dr, shared by its spokes, which alternate by half a step
    strength = (1 - radius) ** 2 * radius * (2 * np.pi / rings / spokes)
    total = np.zeros_like(x)
    for q, s, turn in zip(radius, strength, np.arange(rings) % 2):
        for angle in (np.arange(spokes) + 0.5 * turn) * (2 * np.pi / spokes):
            way = np.array([np.cos(angle), np.sin(angle)])
            total -= way[:, None] * (s * reach**2 * density(x + q * reach * way[:, None]))
    return total
