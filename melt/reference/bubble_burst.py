"""Bubbles at the surface: which ones leave, and what a burst does to the liquid. Boiling spec 2.5, eq (14)."""

import numpy as np

from melt.reference._column import STEPS, column

MOST = 2**30


def surface_column(position, phase, grid, bubbles, surface_column):
    """Write the height of the highest liquid or solid in each column above the floor, in steps of 1/4096 spacing; -1 without.

    Rounded to the nearest step in the precision of the positions, from 0 to 2^30: integers have one maximum in
    whatever order they come.

    Reads: position (3, n) [m], phase (n,). Writes: surface_column (nx ny,).
    """
    real = position.dtype.type
    on = phase <= 1
    with np.errstate(over="ignore"):
        t = (position[2, on] - real(bubbles.floor)) * (real(STEPS) / real(bubbles.spacing)) + real(0.5)
    steps = np.where(t > 0, np.minimum(t, real(MOST)), 0).astype(np.int64)
    surface_column[:] = -1
    np.maximum.at(surface_column, column(position[:, on], grid), steps)


def burst_test(
    position, bubble_radius, bubble_index, bubble_count, surface_column, grid, bubbles, height, bubble_fate, burst_top
):
    """Write which bubbles reach the surface, z + r >= top: 1 small ones that vanish, 2 those that burst, 0 for all else.

    The top is that of the liquid in the bubble's own column (the bubble's centre if it has none), but not above
    ``height`` over the floor. A bubble without radius merged away in this step, and stays out.

    Reads: position (3, n) [m], bubble_radius (n,) [m], bubble_index (n,), surface_column (nx ny,).
    Writes: bubble_fate (n,), burst_top (n,) [m]; 0 for others than bubbles.
    """
    bubble_fate[:], burst_top[:] = 0, 0
    floor, step = float(bubbles.floor), float(bubbles.spacing) / STEPS
    highest = surface_column[column(position, grid)]
    for i in bubble_index[: int(bubble_count[0])]:
        r, z = float(bubble_radius[i]), float(position[2, i]) - floor
        if not r > 0:
            continue
        top = min(highest[i] * step if highest[i] >= 0 else z, float(height))
        burst_top[i] = floor + top
        if z + r >= top:
            bubble_fate[i] = 1 if bubble_radius[i] <= bubbles.burst_radius else 2


def burst_push(position, phase, burst_index, burst_count, burst_top, bubbles, velocity):
    r"""Push the liquid around each burst outwards and up. Eq (14).

    .. math:: dv_{xy} = \frac{l_1}{t_p} (x - c)_{xy}\, w(q), \quad dv_z = \frac{l_2}{t_p} |c_z - z|\, w(q),
        \quad q = |x - c|/(k_b R) < 1, \quad w = 1 - q

    with c above the bubble, at the surface; w = 1 with ``push_even``. Several bursts add up by ascending id.

    Reads: position (3, n) [m], phase (n,), burst_index (n,) by ascending id, burst_top (n,) [m].
    Writes: velocity (3, n) [m/s] of liquid.
    """
    on = np.flatnonzero(phase == 0)
    x = position[:, on].astype(np.float64)
    dv = np.zeros((3, on.size))
    for b in burst_index[: int(burst_count[0])]:
        c = np.array([position[0, b], position[1, b], burst_top[b]], dtype=np.float64)
        d = x - c[:, None]
        q = np.sqrt((d**2).sum(axis=0)) / float(bubbles.push_reach)
        w = np.where(q < 1, 1.0 if bubbles.push_even == 1 else 1 - q, 0.0)
        dv[:2] += float(bubbles.push_side) * d[:2] * w  # (14)
        dv[2] += float(bubbles.push_up) * np.abs(d[2]) * w
    velocity[:, on] = velocity[:, on].astype(np.float64) + dv


def remove_bubbles(bubble_index, bubble_count, bubble_fate, cargo, phase, released):
    """Take bubbles that vanish or burst out; all their other fields stay as they are for the rest of the step.

    Reads: bubble_index (n,), bubble_fate, cargo (n,).
    Writes: phase (n,) of those; released (3, 64): how many vanish, burst, and the cargo of both, by places in the list.
    """
    slots = bubble_index[: int(bubble_count[0])]
    fate = bubble_fate[slots]
    phase[slots[fate > 0]] = 5
    rows = np.array([fate == 1, fate == 2, np.where(fate > 0, cargo[slots], 0)], dtype=np.int64)
    pieces = released.shape[1]
    for p in range(pieces):
        released[:, p] = rows[:, p * slots.size // pieces : (p + 1) * slots.size // pieces].sum(axis=1)
