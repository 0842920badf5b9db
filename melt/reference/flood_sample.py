r"""Depth at the points of a map and at gauges. Flood spec 9 ("two raster operators").

.. math::
    c = \sum_j A_j W(r_j, h_j), \quad \eta = \frac1c \sum_j A_j W(r_j, h_j)\,\eta_j, \quad
    \bar d = \sum_j V_j W(r_j, h_j), \qquad A_j = V_j/d_j, \quad \eta_j = b_j + d_j

:math:`\eta` (Shepard) gives the best depths, :math:`\eta - b` where c exceeds ``cover``; :math:`\bar d` conserves
volume: its integral is that of the water.
"""

import numpy as np

from melt.reference._flood_motion import W2


def flood_sample(
    sample_position, sample_bed, position, velocity, phase, rest_volume, depth, bed, support_radius, cell_start, cell_reach,
    grid, flood, sampling, sample_surface, sample_depth, sample_column, sample_speed,
):
    """Write surface, depth, conservative depth and speed of the water at each point.

    The surface stands at most twice the mean depth of its columns above the bed: on a hillside a thin, wide column
    elsewhere on the slope says nothing of the surface here (rain drew lakes of 5 m). A point is dry where c <= cover
    or where the surface does not stand above its bed: the surface is the bed, depth and speed are 0. A NaN of the water
    shows.

    Reads: sample_position (2, samples) [m], sample_bed (samples,) [m]; of liquid columns position, velocity,
        rest_volume, depth, bed, support_radius; the grid is not used (all pairs).
    Writes: sample_surface [m], sample_depth [m], sample_column [m], sample_speed [m/s], all (samples,).
    """
    on = phase == 0
    x, h, V = position[:2, on].astype(np.float64), support_radius[on].astype(np.float64), rest_volume[on].astype(np.float64)
    d, v = depth[on].astype(np.float64), velocity[:2, on].astype(np.float64)
    eta, speed, A = bed[on].astype(np.float64) + d, np.hypot(v[0], v[1]), V / d
    for s in range(sample_surface.shape[0]):
        b = float(sample_bed[s])
        r = np.hypot(*(x - sample_position[:, s : s + 1].astype(np.float64)))
        near = r < h
        W = W2(r[near], h[near], flood)
        cover, surface, fast = (A[near] * W).sum(), b, 0.0
        sample_column[s] = (V[near] * W).sum()
        if not cover <= float(sampling.cover):
            surface = (A[near] * W * eta[near]).sum() / cover
            most = b + 2 * (V[near] * W).sum() / cover
            surface = most if surface > most else surface
            fast = (A[near] * W * speed[near]).sum() / cover
        if surface <= b:
            surface, fast = b, 0.0
        sample_surface[s], sample_depth[s], sample_speed[s] = surface, surface - b, fast


def keep_most(
    sample_depth, sample_speed, sampling, time, dt, most_depth, most_speed, most_flux, arrival_time, wet_time,
):
    """Keep the largest depth, speed and depth times speed so far, when the water came, and for how long it stood.

    Reads: sample_depth [m], sample_speed [m/s] (samples,); time [s] now, dt [s] since the last call.
    Writes: most_depth [m], most_speed [m/s], most_flux [m^2/s], arrival_time [s] (-1: not yet), wet_time [s].
    """
    d, v = sample_depth.astype(np.float64), sample_speed.astype(np.float64)
    for most, now in ((most_depth, d), (most_speed, v), (most_flux, d * v)):
        most[:] = np.where(now > most, now, most)
    wet = d > float(sampling.wet)
    arrival_time[:] = np.where(wet & (arrival_time < 0), float(time), arrival_time)
    wet_time[:] = wet_time + np.where(wet, float(dt), 0.0)
