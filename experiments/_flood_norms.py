"""Error measures of floods: against exact solutions, and against gauges."""

import numpy as np
from scipy.optimize import least_squares


def l1_depth(depth, exact, area=1.0):
    """Return sum A |d - d_exact| / sum A d_exact; arrays of one shape, ``area`` [m^2] an array or one for all."""
    area = np.broadcast_to(area, np.shape(depth))
    return float((area * np.abs(depth - exact)).sum() / (area * exact).sum())


def velocity_error(velocity, exact, mass=1.0):
    """Return sum m |v - v_exact| / sum m |v_exact|; shape S, or S + (2,) if ``mass`` of shape S is not a number."""
    velocity, exact = np.asarray(velocity), np.asarray(exact)
    if velocity.ndim > np.ndim(mass) > 0:
        off, size = np.linalg.norm(velocity - exact, axis=-1), np.linalg.norm(exact, axis=-1)
    else:
        off, size = np.abs(velocity - exact), np.abs(exact)
    mass = np.broadcast_to(mass, off.shape)
    return float((mass * off).sum() / (mass * size).sum())


def front_position(x, depth, threshold=1e-3):
    """Return the largest x [m] where the depth crosses ``threshold`` [m], interpolated to the next sample; NaN if it never does."""
    order = np.argsort(x)
    x, depth = np.asarray(x, float)[order], np.asarray(depth, float)[order]
    wet = np.flatnonzero(depth > threshold)
    if not len(wet):
        return float("nan")
    i = wet[-1]
    if i + 1 == len(x):
        return float(x[i])
    return float(x[i] + (x[i + 1] - x[i]) * (depth[i] - threshold) / (depth[i] - depth[i + 1]))


def shock_position(x, depth, high, low):
    """Return where [m] the last step from ``high`` down to ``low`` (seen from the right) crosses their mean."""
    return front_position(x, depth, 0.5 * (high + low))


def jump_position(x, stage, low, high, after=-np.inf):
    """Return the first x [m] beyond ``after`` where the stage rises through the mean of ``low`` and ``high``; NaN if it never does."""
    order = np.argsort(x)
    x, stage, middle = np.asarray(x, float)[order], np.asarray(stage, float)[order], 0.5 * (low + high)
    rises = np.flatnonzero((stage[:-1] <= middle) & (stage[1:] > middle) & (x[1:] > after))
    if not len(rises):
        return float("nan")
    i = rises[0]
    return float(x[i] + (x[i + 1] - x[i]) * (middle - stage[i]) / (stage[i + 1] - stage[i]))


def fit_oscillation(t, y, period):
    """Fit y = offset + amplitude cos(2 pi t/period - phase); return (amplitude, period, phase, offset).

    ``period`` [s] is the guess; amplitude >= 0 in the units of y (n,), the phase lies in (-pi, pi].
    """
    t, y = np.asarray(t, float), np.asarray(y, float)

    def basis(omega):
        return np.stack([np.ones_like(t), np.cos(omega * t), np.sin(omega * t)], -1)

    def residual(scale):
        columns = basis(scale[0] * 2 * np.pi / period)
        return columns @ np.linalg.lstsq(columns, y, rcond=None)[0] - y

    # a fit from one start may end in the next trough of the misfit: the best of a few starts is kept
    fits = [least_squares(residual, [start], xtol=1e-14, ftol=1e-14) for start in (0.9, 0.95, 1.0, 1.05, 1.1)]
    scale = min(fits, key=lambda f: f.cost).x[0]
    offset, cos, sin = np.linalg.lstsq(basis(scale * 2 * np.pi / period), y, rcond=None)[0]
    return float(np.hypot(cos, sin)), float(period / scale), float(np.arctan2(sin, cos)), float(offset)


def ring_symmetry(x, y, depth, edges, centre=(0.0, 0.0), fewest=8):
    """Return std/mean of the depth on rings between radii ``edges`` (k + 1,) [m]: (k,), NaN on rings of few samples.

    The straight line in r that fits a ring best is taken off first: a ring has a width, and the depth's slope across it is
    no asymmetry.
    """
    r, found = np.hypot(np.asarray(x) - centre[0], np.asarray(y) - centre[1]), []
    for inner, outer in zip(edges[:-1], edges[1:]):
        on = (r >= inner) & (r < outer)
        if on.sum() < fewest:
            found.append(np.nan)
            continue
        d, columns = np.asarray(depth)[on], np.stack([np.ones(on.sum()), r[on] - 0.5 * (inner + outer)], -1)
        found.append(np.std(d - columns @ np.linalg.lstsq(columns, d, rcond=None)[0]) / d.mean())
    return np.array(found)


def observed_order(errors, sizes):
    """Return the slope of log(error) over log(size) by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def _at(t_obs, t, y):
    """Return the simulated series at the instants of the observation, and which of them it covers."""
    t_obs = np.asarray(t_obs, float)
    return np.interp(t_obs, t, y), (t_obs >= t[0]) & (t_obs <= t[-1])


def rmse(t_obs, y_obs, t, y):
    """Return the root mean square of simulated minus observed, at the instants of the observation that the run covers."""
    found, inside = _at(t_obs, t, y)
    return float(np.sqrt(np.mean((found - y_obs)[inside] ** 2)))


def bias(t_obs, y_obs, t, y):
    """Return the mean of simulated minus observed, as `rmse`."""
    found, inside = _at(t_obs, t, y)
    return float(np.mean((found - y_obs)[inside]))


def peak(t, y, start=-np.inf, end=np.inf):
    """Return (largest value, its time) within ``start`` <= t <= ``end``."""
    t, y = np.asarray(t, float), np.asarray(y, float)
    inside = np.flatnonzero((t >= start) & (t <= end))
    i = inside[np.nanargmax(y[inside])]
    return float(y[i]), float(t[i])


def arrival(t, y, threshold):
    """Return when y first crosses ``threshold`` from below, interpolated; NaN if never. A start above it counts as t[0]."""
    t, y = np.asarray(t, float), np.asarray(y, float)
    above = np.flatnonzero(y > threshold)
    if not len(above):
        return float("nan")
    i = above[0]
    if i == 0:
        return float(t[0])
    return float(t[i - 1] + (t[i] - t[i - 1]) * (threshold - y[i - 1]) / (y[i] - y[i - 1]))


def relative_error(simulated, observed):
    """Return |simulated - observed| / observed, the measure of the paper's Table 2."""
    return np.abs(np.asarray(simulated, float) - observed) / np.abs(observed)
