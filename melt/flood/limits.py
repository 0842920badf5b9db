"""Time step of a flood. Flood spec E20."""

import math

import numpy as np

from melt.systems.reads import finite

CLAMPED = 0.05  # share of columns at a limit of their support from which a run warns


def limit(do):
    """Return (longest stable sub-step [s], name of the bound) for the water of now, and keep its speed and support.

    Raises:
        NotFinite: a speed, depth or force is not finite.
    """
    s, clock = do.settings, do.clock
    rows = np.asarray(do.read("flood_bounds"), dtype=np.float64)
    wave, push, move, clock.max_speed, clock.largest_support = (float(v) for v in rows[:5].max(axis=1))
    clock.max_acceleration = push
    finite(wave + push + move + clock.max_speed)  # before the motion carries it on: fewest columns have it
    clamped = float(rows[5].sum())
    do.note("clamped_columns", clamped)
    if clamped > CLAMPED * max(clock.active, 1) and not do.warning:
        do.warning = (
            f"support radii: those of {clamped / max(clock.active, 1):.0%} of the columns are at a limit "
            f"(solver.support_limits = {[round(float(f), 4) for f in s.support_limits]} of {s.support:.4g} m): the depth there is "
            "not resolved. Fix: a smaller fluid.spacing or fluid.reference_depth, or wider limits"
        )
    bounds = limits_of(s.cfl, wave, push, move)
    if s.fall > 0 and clock.time < 2 * s.fall:  # columns that fall bound nothing else, and must not fall through the water
        bounds["fall"] = s.fall / 40
    name = min(bounds, key=bounds.get)
    return bounds[name], name


def limits_of(cfl, wave, push, move):
    """Return {bound: seconds} of E20 from the largest (sqrt(g d) + |v|)/l, |a|/l and |v|/min(l, terrain cell)."""
    return {
        "wave": cfl / max(wave, 1e-12),
        "force": 0.25 / math.sqrt(max(push, 1e-12)),
        "terrain": 0.5 / max(move, 1e-12),
    }
