r"""Depth of a height field. Flood spec 5, R0.

Between its nodes the height is bilinear, so that along a ray :math:`g(t) = z(t) - b(x(t), y(t))` is a quadratic in
every cell; the surface is where g first turns from above to not above 0. Cells with a node that is not finite are holes.
Rays that come in below the surface, not below the base, meet the cut face of the block there.
"""

import numpy as np

from melt.reference._screen import rays


def relief_depth(relief_height, relief, view, behind_depth):
    """Write the depth at which the rays meet the block under the height field, infinity if they do not.

    Every crossing of a ray with a grid line is found and sorted: no walk through the cells, as the twins do.
    Reads: relief_height (ny, nx) [m]. Writes: behind_depth (h, w) [m].
    """
    Z = relief_height.astype(np.float64)
    ny, nx = Z.shape
    u, v = (a.ravel() for a in rays(behind_depth.shape, view))
    axes = np.array([[getattr(view, f"{a}_{k}") for k in "xyz"] for a in ("right", "down", "forward")], np.float64)
    slope = np.stack([u, v, np.ones_like(u)], axis=1) @ axes
    cell = np.array([relief.cell_x, relief.cell_y], np.float64)
    start = (np.array([view.eye_x, view.eye_y], np.float64) - np.array([relief.lower_x, relief.lower_y], np.float64)) / cell
    eye_z, rate = float(view.eye_z), slope[:, :2] / cell
    lines = [(np.arange(m)[None, :] - start[k]) / np.where(rate[:, k] == 0, np.nan, rate[:, k])[:, None] for k, m in ((0, nx), (1, ny))]
    t = np.sort(np.concatenate([np.where(np.nan_to_num(a, nan=-1) > 0, a, 0) for a in lines], axis=1), axis=1)
    found, entered = np.full(len(u), np.inf), np.zeros(len(u), bool)
    for k in range(t.shape[1] - 1):
        t0, t1 = t[:, k], t[:, k + 1]
        x, y = (start[m] + rate[:, m] * (t0 + t1) / 2 for m in (0, 1))
        inside = (t1 > t0) & (x > 0) & (x < nx - 1) & (y > 0) & (y < ny - 1) & np.isinf(found)
        i, j = np.clip(x, 0, nx - 2).astype(int), np.clip(y, 0, ny - 2).astype(int)

        def above(at, i=i, j=j):
            a, b = start[0] + rate[:, 0] * at - i, start[1] + rate[:, 1] * at - j
            low = (1 - a) * Z[j, i] + a * Z[j, i + 1]
            return eye_z + slope[:, 2] * at - (1 - b) * low - b * ((1 - a) * Z[j + 1, i] + a * Z[j + 1, i + 1])

        g0, gm, g1 = above(t0), above((t0 + t1) / 2), above(t1)
        hit = inside & (g0 > 0) & (g1 <= 0)
        A, B = 2 * g0 - 4 * gm + 2 * g1, 4 * gm - 3 * g0 - g1
        s = 2 * g0 / np.where(hit, np.sqrt(np.maximum(B * B - 4 * A * g0, 0)) - B, 1)
        found = np.where(hit, t0 + s * (t1 - t0), found)
        cut = inside & ~entered & (t0 > 0) & (g0 <= 0) & (eye_z + slope[:, 2] * t0 >= float(relief.base))
        found, entered = np.where(cut, t0, found), entered | inside
    behind_depth[:] = found.reshape(behind_depth.shape)
