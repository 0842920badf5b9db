r"""Motion of columns. Flood spec 1, stages 3 and 10.

.. math:: v \mathrel{+}= a\,dt, \qquad x \mathrel{+}= v\,dt

LIQUID columns (phase 0) move in the plane; z is their surface. AIRBORNE ones (6) fall freely, which the spec
has no equation for (its figure of a fall from a cliff only): they keep v, gravity acts on w alone.
"""

import numpy as np


def flood_kick(phase, acceleration, flood, dt, velocity):
    """Accelerate columns by dt: water along the plane, falling columns downwards.

    Reads: phase (n,), acceleration (2, n) [m/s^2]. Writes: velocity (3, n) [m/s]; others keep theirs.
    """
    water, falling, dt = phase == 0, phase == 6, float(dt)
    velocity[:2, water] = velocity[:2, water] + dt * acceleration[:, water].astype(np.float64)
    velocity[2, falling] = velocity[2, falling] - dt * float(flood.gravity)


def flood_drift(phase, velocity, basin, dt, position, position_before):
    """Move columns by dt and keep where they were; a move in the plane longer than ``longest_move`` is cut to it.

    Reads: phase (n,), velocity (3, n) [m/s].
    Writes: position (3, n), position_before (3, n, or 3, 0 without a control force) [m] of liquid and airborne
        columns; others keep theirs.
    """
    on, falling, dt = (phase == 0) | (phase == 6), phase == 6, float(dt)
    if position_before.shape[1]:
        position_before[:, on] = position[:, on]
    move = dt * velocity[:, on].astype(np.float64)
    length, most = np.hypot(move[0], move[1]), float(basin.longest_move)
    with np.errstate(invalid="ignore"):  # infinite: comes out as NaN
        move[:2] *= np.where(length > most, most / np.where(length > most, length, 1.0), 1.0)
    move[2] = np.where(falling[on], move[2], 0.0)
    position[:, on] = position[:, on].astype(np.float64) + move


def flood_land(bed, depth, position, phase, velocity):
    """Let airborne columns become water where they have come down to its surface; their fall is lost.

    Reads: bed (n,), depth (n,) [m] (of an airborne column: of the water under it), position (3, n) [m].
    Writes: phase (n,), velocity (3, n) [m/s] of columns that land; others keep theirs.
    """
    surface = bed.astype(np.float64) + depth.astype(np.float64)
    down = (phase == 6) & (position[2].astype(np.float64) <= surface)
    phase[down] = 0
    velocity[2, down] = 0


def damp_columns(phase, factor, velocity):
    """Multiply the velocity of water by a factor (relaxation start). Flood spec E6, judgement b.

    Reads: phase (n,). Writes: velocity (3, n) [m/s] of liquid columns; others keep theirs.
    """
    velocity[:, phase == 0] = float(factor) * velocity[:, phase == 0].astype(np.float64)
