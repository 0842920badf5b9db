"""What the reference of a flood's motion, entry and maps shares: kernel, bilinear fields, fixed shares of a sum."""

import numpy as np

LIQUID, INACTIVE, AIRBORNE = 0, 5, 6
PIECES = 64


def W2(r, h, flood):
    """Return W(r, h) [1/m^2], h the support radius. Flood spec 0: 0 cubic spline, 1 Wendland C2."""
    l = np.asarray(h, dtype=np.float64) / 2  # noqa: E741  (the smoothing length of the spec)
    q = np.asarray(r, dtype=np.float64) / l
    if flood.kernel == 0:
        s = 10 / (7 * np.pi * l**2)
        inner = 1 - 1.5 * q**2 + 0.75 * q**3
        return float(flood.sigma) * s * np.where(q < 1, inner, np.where(q < 2, 0.25 * (2 - q) ** 3, 0.0))
    return float(flood.sigma) * 7 / (4 * np.pi * l**2) * np.where(q < 2, (1 - q / 2) ** 4 * (1 + 2 * q), 0.0)


def bilinear(field, terrain_grid, x, y):
    """Return value and gradient of a field of nodes at one point; beyond the edge it goes on as a constant."""
    nx, ny = int(terrain_grid.nx), int(terrain_grid.ny)
    z = np.asarray(field, dtype=np.float64).reshape(ny, nx)
    scale = float(terrain_grid.inverse_dx), float(terrain_grid.inverse_dy)
    t = (x - float(terrain_grid.origin_x)) * scale[0], (y - float(terrain_grid.origin_y)) * scale[1]
    k = [int(np.floor(np.clip(a, -2, n + 1))) for a, n in zip(t, (nx, ny))]
    u, v = (np.clip(a, -2, n + 1) - b for a, b, n in zip(t, k, (nx, ny)))
    i, j = (np.clip([b, b + 1], 0, n - 1) for b, n in zip(k, (nx, ny)))
    (a, b), (c, d) = z[np.ix_(j, i)]
    value = (1 - u) * (1 - v) * a + u * (1 - v) * b + (1 - u) * v * c + u * v * d
    slope_x = ((1 - v) * (b - a) + v * (d - c)) * scale[0]
    slope_y = ((1 - u) * (c - a) + u * (d - b)) * scale[1]
    return value, np.array([slope_x, slope_y])


def piece_sums(values):
    """Return 64 sums of ``values`` (n,): piece p has elements p n // 64 to (p + 1) n // 64."""
    n = len(values)
    cuts = [p * n // PIECES for p in range(PIECES + 1)]
    return np.array([values[a:b].astype(np.float64).sum() for a, b in zip(cuts, cuts[1:])])
