r"""False volume of air ghost particles, and density that they complete. Slime spec 2.8, 2.9."""

import numpy as np

from melt.reference._ghosts import apart
from melt.reference._pairs import W, dW

LOT = 1024  # rows at a time


def ghost_volume(
    position, phase, volume, cell_start, ghost_position, ghost_start, grid, smoothing, period, ghost_volume,
):
    r"""Write the false volume of each ghost.

    .. math:: V_g = 1 / \sum_k W(|x_g - x_k|)

    with k over nodes (liquid with volume > 0), boundary particles and ghosts, itself included.

    Reads: position (3, n) [m], phase (n,), volume (n,) [m^3], ghost_position (3, capacity) [m], ghost_start
        (cells + 2,) (its last entry is the number of ghosts); cell_start is not used (all pairs).
    Writes: ghost_volume (capacity,) [m^3], as many as there are ghosts.
    """
    number = min(int(ghost_start[-1]), ghost_position.shape[1])
    there = ((phase == 0) & (volume > 0)) | ((phase != 0) & (phase != 5))
    g = ghost_position[:, :number].astype(np.float64)
    k = np.concatenate([position[:, there].astype(np.float64), g], axis=1)
    for first in range(0, number, LOT):
        lot = slice(first, min(first + LOT, number))
        ghost_volume[lot] = 1 / W(np.sqrt(apart(g[:, lot], k, period)), smoothing).sum(axis=1)


def ghost_complete(
    position, density_ratio, dfsph_factor, ghost_position, ghost_volume, ghost_start, grid, smoothing, period, poisson,
    completed_ratio, ghost_laplacian,
):
    r"""Write the density ratio completed by ghosts, and their part in the Laplacian of the pressure.

    .. math::
        s^c_i = \min(s_i + \sum_g V_g W_{ig}, \max(s_i, 1)) \qquad
        \sum_g V_g F(r) \frac{r^2}{r^2 + \epsilon^2}, \quad F = -W'(r)/r

    for particles with a pressure (dfsph_factor > 0). The cap is mandatory: ghosts are seeded anew in every
    step, and without it their noise explodes. Others keep their ratio, and have no such part.

    Reads: position (3, n) [m], density_ratio (n,), dfsph_factor (n,), ghost_position (3, capacity) [m],
        ghost_volume (capacity,) [m^3], ghost_start (cells + 2,).
    Writes: completed_ratio (n,), ghost_laplacian (n,) [1/m^2].
    """
    number = min(int(ghost_start[-1]), ghost_position.shape[1])
    s = density_ratio.astype(np.float64)
    completed_ratio[:], ghost_laplacian[:] = s, 0.0
    active = np.flatnonzero(dfsph_factor > 0)
    g, V = ghost_position[:, :number].astype(np.float64), ghost_volume[:number].astype(np.float64)
    for first in range(0, active.size, LOT):
        i = active[first : first + LOT]
        r2 = apart(position[:, i].astype(np.float64), g, period)
        r = np.sqrt(r2)
        completed_ratio[i] = np.minimum(s[i] + (V * W(r, smoothing)).sum(axis=1), np.maximum(s[i], 1.0))
        F = np.where(r > 1e-9 * float(smoothing.support), -dW(r, smoothing) / np.where(r > 0, r, 1.0), 0.0)
        ghost_laplacian[i] = (V * F * r2 / (r2 + float(poisson.floor))).sum(axis=1)
