"""Columns that follow the bed. Flood spec 2, E6 (constrained)."""

import numpy as np


def constrain_to_bed(phase, velocity, bed_slope, bed_curvature, flood, acceleration):
    """Turn the acceleration -t - g grad b of liquid columns into that of a column that keeps to the bed.

    With z = b(x) the bed pushes along (-grad b, 1) with lambda per unit mass: x'' = -t - lambda grad b and
    z'' = lambda - g = grad b . x'' + v . K v, from which lambda = (g + v . K v - t . grad b)/(1 + |grad b|^2).

    Reads: phase (n,), velocity (3, n) [m/s], bed_slope (2, n) [1], bed_curvature (3, n) [1/m].
    Writes: acceleration (2, n) [m/s^2], which it also reads.
    """
    wet, g = phase == 0, float(flood.gravity)
    u, v = velocity[:2].astype(np.float64)
    slope, (xx, yy, xy) = bed_slope.astype(np.float64), bed_curvature.astype(np.float64)
    t = -acceleration.astype(np.float64) - g * slope
    vKv = xx * u**2 + yy * v**2 + 2 * xy * u * v
    push = (g + vKv - (t * slope).sum(axis=0)) / (1 + (slope**2).sum(axis=0))
    acceleration[:, wet] = (-push * slope - t)[:, wet]
