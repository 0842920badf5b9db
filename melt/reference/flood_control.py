r"""Terrain velocity control force. Flood spec 3, E11-E13.

A column that moved by Delta = x - x_before looks ahead by a probe, p = Delta/|Delta| max(|Delta|, least probe). At a
point X the bed falls by s = (b(X) - b(X + p))/|p| per metre, and the brake there is

.. math:: f(X) = g |s| \beta(|s|) w(s), \quad \beta(s) = G(s) \frac{s^2}{1 + s^2}, \quad
    G = \mathrm{smoothstep}\Big(\frac{s - s_{on}}{s_{full} - s_{on}}\Big)

No dt in it: with G = 1 the drive g s along a slope becomes g s/(1 + s^2), that of a body that slides on it. The
column takes the mean of f at the corners x +- l of a square (E12), l = c_s h within limits (E13).
"""

import numpy as np

from melt.reference._flood import sample

PAPER, DESCENT = 0, 1
STILL = 1e-6  # moves shorter than this part of the least probe have no direction


def _brake_at(X, p, length, terrain, terrain_grid, control, g):
    """Return f [m/s^2] at X (2, n)."""
    b = [sample(at, terrain, terrain_grid, int(terrain_grid.sampler))[0] for at in (X, X + p)]
    s = (b[0] - b[1]) / length
    steep, on, full = np.abs(s), float(control.slope_on), float(control.slope_full)
    t = np.clip((steep - on) / (full - on), 0.0, 1.0) if full > on else np.ones_like(s)
    beta = t * t * (3 - 2 * t) * s**2 / (1 + s**2)
    if control.mode == PAPER:
        w = 1.0
    elif control.mode == DESCENT:
        w = np.where(s > 0, 1.0, 0.0)
    else:
        w = np.sign(s)
    return g * steep * beta * w  # E11


def control_brake(position, position_before, phase, support_radius, terrain, terrain_grid, control, flood, brake):
    """Write the brake of liquid columns that moved; 0 for others.

    Reads: position and position_before (3, n) [m], phase (n,), support_radius (n,) [m], terrain (nodes,) [m].
    Writes: brake (n,) [m/s^2]; < 0 (mode bead, uphill) speeds up.
    """
    x = position[:2].astype(np.float64)
    Delta = x - position_before[:2].astype(np.float64)
    move, least = np.sqrt((Delta**2).sum(axis=0)), float(control.probe)
    on = (phase == 0) & ~(move <= STILL * least)
    x, Delta, move = x[:, on], Delta[:, on], move[on]
    length = np.maximum(move, least)
    p = Delta / move * length
    h = support_radius[on].astype(np.float64)
    side = np.clip(float(control.spread) * h, float(control.shortest), float(control.longest))  # E13
    corners = [np.array([[e_x], [e_y]]) for e_x in (-1, 1) for e_y in (-1, 1)]
    g = float(flood.gravity)
    f = [_brake_at(x + side * e, p, length, terrain, terrain_grid, control, g) for e in corners]
    brake[:] = 0.0
    brake[on] = sum(f) / 4  # E12
