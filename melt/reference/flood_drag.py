r"""Bed friction and the brake of the terrain velocity control force. Flood spec 2 and 3, E15, E12b.

Point-implicit: with the friction slope S_f = C |v| v, :math:`v \leftarrow v / (1 + \Delta t\, C |v|)`, which decays
towards 0 and never reverses. C [1/m] is g n^2/d^{4/3} (Manning), g/(C_h^2 d) (Chezy) or f/(8 d) (Darcy-Weisbach). Then
:math:`v \leftarrow v \max(0, 1 - a_c \Delta t/|v|)`; where a_c < 0 the column gains at most half its speed.
"""

import numpy as np

MANNING, CHEZY = 0, 1


def _nearest(field, position, grid):
    """Return the values of the nodes nearest to the columns; outside, of the nearest node of the edge."""
    i = np.floor((position[0] - float(grid.origin_x)) * float(grid.inverse_dx) + 0.5)
    j = np.floor((position[1] - float(grid.origin_y)) * float(grid.inverse_dy) + 0.5)
    i, j = np.clip(i, 0, grid.nx - 1).astype(int), np.clip(j, 0, grid.ny - 1).astype(int)
    return field.astype(np.float64)[j * int(grid.nx) + i]


def flood_drag(position, phase, depth, brake, terrain_friction, flood, terrain_grid, friction, dt, velocity):
    """Slow liquid columns by friction, then by the control force; columns at rest stay so.

    Reads: position (3, n) [m], phase (n,), depth (n,) [m], brake (n,) [m/s^2], terrain_friction (nodes,) (mapped only).
    Writes: velocity (3, n) [m/s], of which it changes x and y.
    """
    g, dt = float(flood.gravity), float(dt)
    speed = np.hypot(*velocity[:2].astype(np.float64))
    on = (phase == 0) & (speed != 0)
    speed, d = speed[on], np.maximum(depth[on].astype(np.float64), float(friction.thinnest))
    value = np.full(len(d), float(friction.value))
    if friction.mapped == 1:
        value = _nearest(terrain_friction, position[:, on].astype(np.float64), terrain_grid)
    with np.errstate(divide="ignore"):
        if friction.law == MANNING:
            C = g * value**2 / d ** (4 / 3)
        elif friction.law == CHEZY:
            C = g / (value**2 * d)
        else:
            C = value / (8 * d)
    factor = 1 / (1 + dt * C * speed)  # E15
    if friction.control == 1:
        left = factor * speed
        share = 1 - brake[on].astype(np.float64) * dt / np.where(left > 0, left, 1.0)
        factor = factor * np.where(left > 0, np.clip(share, 0.0, 1.5), 1.0)  # E12b
    velocity[:2, on] = velocity[:2, on].astype(np.float64) * factor
