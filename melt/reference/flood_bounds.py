"""What the time step of a flood is bounded by. Flood spec 2, E20."""

import numpy as np


def flood_bounds(phase, velocity, acceleration, depth, support_radius, depth_state, flood, terrain_grid, flood_bounds):
    """Write the largest values over each of 64 pieces of the columns, liquid ones only; NaN counts as infinity.

    Reads: phase (n,), velocity (3, n) [m/s], acceleration (2, n) [m/s^2], depth, support_radius (n,) [m],
        depth_state (n,).
    Writes: flood_bounds (6, 64): (sqrt(g d) + |v|)/l [1/s], |a|/l [1/s^2], |v|/min(l, terrain cell) [1/s],
        |v| [m/s], h [m], and the number of columns whose h is clamped.
    """
    n, pieces = len(phase), flood_bounds.shape[1]
    v, a = velocity[:2].astype(np.float64), acceleration.astype(np.float64)
    d, h = depth.astype(np.float64), support_radius.astype(np.float64)
    ell, cell = h / 2, 1 / max(float(terrain_grid.inverse_dx), float(terrain_grid.inverse_dy))
    speed = np.sqrt((v**2).sum(axis=0))
    with np.errstate(divide="ignore", invalid="ignore"):
        rows = np.array(
            [
                (np.sqrt(float(flood.gravity) * d) + speed) / ell,
                np.sqrt((a**2).sum(axis=0)) / ell,
                speed / np.where(ell > cell, cell, ell),
                speed,
                h,
            ]
        )
    rows = np.where(np.isnan(rows), np.inf, rows)
    clamped = (depth_state & 3) != 0
    for p in range(pieces):
        part = np.arange(p * n // pieces, (p + 1) * n // pieces)
        part = part[phase[part] == 0]
        flood_bounds[:5, p] = rows[:, part].max(axis=1, initial=0.0)
        flood_bounds[5, p] = clamped[part].sum()
