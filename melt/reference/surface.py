"""Free surface of liquids and solids. Melting spec 2.8."""

import numpy as np

from melt.reference._pairs import gradW, separations


def surface(position, phase, volume, neighbour_count, neighbour_index, smoothing, full_neighbours, surface):
    """Write 1 for liquid and solid particles with |Sum_j V_j gradW_ij| h > 0.5 or too few neighbours.

    Too few: less than 0.75 of ``full_neighbours``, the number inside a full lattice. All
    phases count as neighbours, so what touches a wall or another body is not on the surface.
    Reads: position (3, n) [m], phase (n,), volume (n,) [m^3]; all pairs. Writes: surface (n,).
    """
    x_ij, r = separations(position)
    h = float(smoothing.support)
    V = np.where(phase == 5, 0.0, volume.astype(np.float64))
    g = (V[None, :] * gradW(x_ij, r, smoothing)).sum(axis=2)
    near = (r < h) & (phase != 5)[None, :] & ~np.eye(len(phase), dtype=bool)
    sparse = near.sum(axis=1) < 0.75 * float(full_neighbours)
    surface[:] = ((phase == 0) | (phase == 1)) & ((np.sqrt((g**2).sum(axis=0)) * h > 0.5) | sparse)
