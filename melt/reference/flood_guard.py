"""Edges of the flooded area. Flood spec 1 stage 4, E14-E16 (guard), 7 (columns that leave the terrain).

The order, for each liquid or airborne column at a finite place:

1. beyond an open side: it leaves, its volume is booked as gone over the edge;
2. beyond a wall side, or closer than ``skin``: put ``skin`` inside, outward velocity removed;
3. closer than ``skin`` to ground that water may not enter (signed distance at the nodes, bilinear): moved along
   the gradient, up to 4 times until at most a hundredth of a node distance is missing, inward velocity removed.
   Deeper inside than two node distances, or still inside after that: it leaves, booked as blocked;
4. step 2 again.

A place that is not finite is left alone: the check of finite values reports it.
"""

import numpy as np

from melt.reference._flood_motion import bilinear, piece_sums

PUSHES = 4


def _leaves(x, y, basin):
    open_ = basin.west, basin.east, basin.south, basin.north
    beyond = x < basin.lower_x, x > basin.upper_x, y < basin.lower_y, y > basin.upper_y
    return any(side == 1 and out for side, out in zip(open_, beyond))


def _walled(x, v, basin):
    """Return place and velocity (2,) inside the wall sides."""
    skin = float(basin.skin)
    for a, low, high, lower, upper in (
        (0, basin.west, basin.east, basin.lower_x, basin.upper_x), (1, basin.south, basin.north, basin.lower_y, basin.upper_y),
    ):
        if low == 0 and x[a] < float(lower) + skin:
            x[a], v[a] = float(lower) + skin, max(v[a], 0.0)
        if high == 0 and x[a] > float(upper) - skin:
            x[a], v[a] = float(upper) - skin, min(v[a], 0.0)


def _pushed(x, v, terrain_wall, terrain_grid, basin):
    """Move a column out of forbidden ground, in place; return whether that failed."""
    cell, skin = max(1 / float(terrain_grid.inverse_dx), 1 / float(terrain_grid.inverse_dy)), float(basin.skin)
    s, slope = bilinear(terrain_wall, terrain_grid, *x)
    if s < -2 * cell:
        return True
    wanted = skin
    for _ in range(PUSHES):
        size = np.hypot(*slope)
        if not (s < wanted and size > 1e-6):
            break
        n = slope / size
        x += (skin - s) * n
        v -= min(v @ n, 0.0) * n
        wanted = skin - 0.01 * cell
        s, slope = bilinear(terrain_wall, terrain_grid, *x)
    return s < -0.01 * cell


def flood_guard(rest_volume, terrain_wall, basin, terrain_grid, phase, position, velocity, left_volume):
    """Keep columns where water may be, and take away those that cannot be there.

    Reads: rest_volume (n,) [m^3], terrain_wall (nodes,) [m] (length 0 without ``guard``).
    Writes: phase (n,) (inactive: left), position (3, n) [m], velocity (3, n) [m/s] of those that stay; others keep
        theirs. left_volume (4, 64) [m^3], whole: gone over the edge, blocked, and two rows of 0; column p has the
        particles p n // 64 to (p + 1) n // 64.
    """
    gone = np.zeros((2, phase.shape[0]))
    for i in np.flatnonzero((phase == 0) | (phase == 6)):
        x, v = position[:2, i].astype(np.float64), velocity[:2, i].astype(np.float64)
        if not np.isfinite(x).all():
            continue
        if _leaves(*x, basin):
            phase[i], gone[0, i] = 5, rest_volume[i]
            continue
        _walled(x, v, basin)
        if basin.guard == 1:
            if _pushed(x, v, terrain_wall, terrain_grid, basin):
                phase[i], gone[1, i] = 5, rest_volume[i]
                continue
            _walled(x, v, basin)
        position[:2, i], velocity[:2, i] = x, v
    left_volume[:] = 0
    left_volume[0], left_volume[1] = piece_sums(gone[0]), piece_sums(gone[1])
