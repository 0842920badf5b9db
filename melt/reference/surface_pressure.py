r"""Pressure of surface tension at the free surface. Slime spec 2.9, 2.13.

The normal is the gradient of the fill, G_i = \sum_j g_ij, which points into the liquid; it means something where
|G| h > 0.1, the outer two layers. Curvature is \kappa_i = \sum_j (n_i - n_j).g_ij over neighbours with a normal, divided
by the share of the kernel that they fill, \sum_j -x_ij.g_ij/d (Morris 2000), and p_s = \sigma \kappa.
"""

import numpy as np

from melt.reference._period import nearest
from melt.reference._shares import rows

LEAST = 0.1  # of |G| h


def surface_normal(dfsph_factor, neighbour_count, neighbour_index, pair_gradient, smoothing, surface_normal):
    """Write n = G/|G| of liquid near the free surface, 0 elsewhere.

    Reads: dfsph_factor (n,) [kg/m] (0: no pressure), the lists, pair_gradient (3, n, m) [1/m].
    Writes: surface_normal (3, n).
    """
    surface_normal[:] = 0
    for i, near in rows(neighbour_count, neighbour_index):
        G = pair_gradient[:, i, : len(near)].astype(float).sum(axis=1)
        size = np.sqrt((G**2).sum())
        if dfsph_factor[i] > 0 and size * float(smoothing.support) > LEAST:
            surface_normal[:, i] = G / size


def surface_pressure(
    position, surface_normal, neighbour_count, neighbour_index, pair_gradient, smoothing, period, sigma, surface_pressure,
):
    """Write p_s = sigma kappa of particles with a normal, 0 elsewhere.

    Curvature is cut at that of a drop of half a support radius, the smallest that the kernel can tell: without the cut a
    drop of 490 particles burst within two periods.

    Reads: position (3, n) [m], surface_normal (3, n), the lists, pair_gradient (3, n, m) [1/m], sigma [N/m].
    Writes: surface_pressure (n,) [Pa].
    """
    n, x = surface_normal.astype(float), position.astype(float)
    surface_pressure[:] = 0
    for i, near in rows(neighbour_count, neighbour_index):
        if not (n[:, i] ** 2).sum() > 0:
            continue
        valid = (n[:, near] ** 2).sum(axis=0) > 0
        g = pair_gradient[:, i, : len(near)].astype(float)[:, valid]
        share = -(nearest(x[:, i, None] - x[:, near[valid]], period) * g).sum() / int(smoothing.dimension)
        turn = ((n[:, i, None] - n[:, near[valid]]) * g).sum()
        sharpest = 2 * (int(smoothing.dimension) - 1) / float(smoothing.support)
        surface_pressure[i] = float(sigma) * np.clip(turn / share if share > SHARE else 0.0, -sharpest, sharpest)


SHARE = 0.1  # of the kernel: with fewer neighbours there is no curvature
