"""Scalar formulas of where columns may move. Flood spec 1, stages 3 and 4."""

import math

import numpy as np

from melt._compile import scalar, scalar_lookup
from melt.params import SIDE_OPEN, SIDE_WALL
from melt.physics.terrain import bilinear_gradient, bilinear_value

PUSHES = 4


@scalar
def cut_move(dx, dy, most):
    """Return (dx, dy), cut to the length ``most``; an infinite move becomes NaN."""
    real = type(most)
    length = math.sqrt(dx * dx + dy * dy)
    share = most / length if length > most else real(1)
    return share * dx, share * dy


@scalar
def inside_box(x, y, x_from, x_to, y_from, y_to):
    """Return whether a point is in a half-open box."""
    return x >= x_from and x < x_to and y >= y_from and y < y_to


@scalar
def leaves(x, y, basin):
    """Return whether (x, y) is beyond an open side."""
    wide = type(x)
    west = basin.west == SIDE_OPEN and x < wide(basin.lower_x)
    east = basin.east == SIDE_OPEN and x > wide(basin.upper_x)
    south = basin.south == SIDE_OPEN and y < wide(basin.lower_y)
    north = basin.north == SIDE_OPEN and y > wide(basin.upper_y)
    return west or east or south or north


@scalar
def between_walls(x, u, low, high, lower, upper, skin):
    """Return place and velocity along one axis, ``skin`` inside those sides that are walls."""
    wide, real = type(x), type(u)
    first, last = wide(lower) + wide(skin), wide(upper) - wide(skin)
    if low == SIDE_WALL and x < first:
        x, u = first, max(u, real(0))
    if high == SIDE_WALL and x > last:
        x, u = last, min(u, real(0))
    return x, u


@scalar
def walled(x, y, u, v, basin):
    """Return place and velocity inside the wall sides."""
    x, u = between_walls(x, u, basin.west, basin.east, basin.lower_x, basin.upper_x, basin.skin)
    y, v = between_walls(y, v, basin.south, basin.north, basin.lower_y, basin.upper_y, basin.skin)
    return x, y, u, v


@scalar_lookup
def pushed(x, y, u, v, terrain_wall, terrain_grid, basin):
    """Return (x, y, u, v, stuck): a column moved out of ground that water may not enter, ``skin`` away from it.

    One push is exact where the distance is that to a straight edge; near corners the gradient turns on the way.
    A hundredth of a node distance is left as it is: repeating for the rounding of the first push would turn the
    velocity by whatever normal is found there.
    """
    wide, real = type(x), type(u)
    cell, skin = real(1) / min(terrain_grid.inverse_dx, terrain_grid.inverse_dy), basin.skin
    s, wanted = bilinear_value(terrain_wall, terrain_grid, x, y), skin
    deep = s < real(-2) * cell
    for _ in range(PUSHES):
        if deep or not s < wanted:
            break
        n_x, n_y = bilinear_gradient(terrain_wall, terrain_grid, x, y)
        size = math.sqrt(n_x * n_x + n_y * n_y)
        if not size > real(1e-6):
            break
        n_x, n_y = n_x / size, n_y / size
        x, y = x + wide((skin - s) * n_x), y + wide((skin - s) * n_y)
        inward = min(u * n_x + v * n_y, real(0))
        u, v = u - inward * n_x, v - inward * n_y
        wanted = skin - real(0.01) * cell
        s = bilinear_value(terrain_wall, terrain_grid, x, y)
    return x, y, u, v, deep or s < real(-0.01) * cell


@scalar_lookup
def guarded(x, y, u, v, terrain_wall, terrain_grid, basin):
    """Return (x, y, u, v, fate) of a column: fate 0 it stays, 1 it left over an open side, 2 it is stuck."""
    wide = type(x)
    if not (abs(x) < wide(np.inf) and abs(y) < wide(np.inf)):
        return x, y, u, v, 0
    if leaves(x, y, basin):
        return x, y, u, v, 1
    x, y, u, v = walled(x, y, u, v, basin)
    if basin.guard == 1:
        x, y, u, v, stuck = pushed(x, y, u, v, terrain_wall, terrain_grid, basin)
        if stuck:
            return x, y, u, v, 2
        x, y, u, v = walled(x, y, u, v, basin)
    return x, y, u, v, 0


@scalar
def kept_volume(V, d, sunk):
    """Return what is left of a column of volume V and depth d when a layer ``sunk`` [m] seeps away. E19."""
    real = type(V)
    kept = V - sunk * V / d
    return real(0) if kept < real(0) else kept  # a NaN stays
