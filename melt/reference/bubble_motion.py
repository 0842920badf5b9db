r"""Motion of bubbles: rise, drag in the liquid with its reaction, drift towards each other. Boiling spec 2.5, eq (13).

A bubble displaces the liquid in the density solve and is not moved by it. It rises by
:math:`a_B = g(\rho_0-\rho_g)/(\rho_g + C_A\rho_0)` against quadratic drag in the liquid around it, with
:math:`S_W = \sum_j W_{bj}, u_b = \sum_j W_{bj} v_j/S_W` over liquid j, poly6 W and k = K/r:

.. math::
    s_0 = |v_b - u_b|, \quad s_1 = \frac{-1 + \sqrt{1 + 4 k \Delta t s_0}}{2 k \Delta t}, \quad
    v_b := u_b + (v_b - u_b) \frac{s_1}{s_0}, \quad v_j := v_j - I_b \Delta v_b \frac{W_{bj}}{S_W m_j}

which ends at :math:`\sqrt{a_B/k}` for any time step, and conserves the momentum of liquid and bubbles with
inertia I_b. (13), RECONSTRUCTED, counts the other bubbles within R on either side:

.. math:: \Delta x = \kappa R \frac{\Delta t}{\Delta t_{ref}} \frac{X_+ - X_-}{X_+ + X_-}
"""

import numpy as np

from melt.reference._pairs import separations
from melt.reference._pbf import listed, pair_supports


def _listed(index, count):
    return index[: int(count[0])]


def _sides(box):
    """Return lower and upper corner of a box (3,) [m]."""
    lower = np.array([box.lower_x, box.lower_y, box.lower_z], dtype=np.float64)
    return lower, np.array([box.upper_x, box.upper_y, box.upper_z], dtype=np.float64)


def _inside(x, r, bubbles):
    """Return the centres x (3, m), each its radius away from the walls; the middle where there is no room."""
    lower, upper = (side[:, None] for side in _sides(bubbles))
    return np.where(2 * r > upper - lower, (lower + upper) / 2, np.clip(x, lower + r, np.maximum(upper - r, lower + r)))


def bubble_predict(bubble_index, bubble_count, bubble_radius, bubbles, dt, velocity, position):
    """Predict bubbles: v += dt a_B, x += dt v, within the walls.

    Reads: bubble_index (n,) of which the first bubble_count[0] count, bubble_radius (n,) [m].
    Writes: velocity (3, n) [m/s] and position (3, n) [m] of the listed.
    """
    on, dt = _listed(bubble_index, bubble_count), float(dt)
    a = np.array([[bubbles.rise_x], [bubbles.rise_y], [bubbles.rise_z]], dtype=np.float64)
    v = velocity[:, on].astype(np.float64) + dt * a
    velocity[:, on] = v
    x = position[:, on].astype(np.float64) + dt * v
    position[:, on] = _inside(x, bubble_radius[on].astype(np.float64), bubbles)


def bubble_exclude(phase, bubble_index, bubble_count, bubble_radius, pbf, vessel, position):
    """Move liquid out of bubbles larger than a spacing, radially, one bubble after the other; within the vessel.

    The volume of so large a bubble is capped in the solve, which therefore does not keep the liquid out of it.
    Liquid at the very centre goes up.

    Reads: phase (n,), bubble_index (n,) of which the first bubble_count[0] count, bubble_radius (n,) [m].
    Writes: position (3, n) [m] of liquid in such a bubble.
    """
    d = float(pbf.spacing)
    lower, upper = _sides(vessel)
    large = [b for b in _listed(bubble_index, bubble_count) if bubble_radius[b] > pbf.spacing]
    for i in np.flatnonzero(phase == 0):
        x, moved = position[:, i].astype(np.float64), False
        for b in large:
            centre, radius = position[:, b].astype(np.float64), float(bubble_radius[b])
            away = x - centre
            r = np.sqrt((away**2).sum())
            if r < radius:
                x = centre + (np.array([0.0, 0.0, radius]) if r <= 1e-9 * d else away * radius / r)
                moved = True
        if moved:
            position[:, i] = np.clip(x, lower, upper)


def _weights(position, support_radius, neighbour_count, neighbour_index, pbf):
    """Return poly6 W_ij (n, n) [1/m^3] of the pairs that stand in the list of i; 0 for others."""
    _, r = separations(position)
    R = pair_supports(position, support_radius, pbf)
    R = np.where(R > 0, R, 1.0)  # of pairs that do not count
    W1 = 315 / (64 * np.pi * R**9) * np.where(r < R, R**2 - r**2, 0.0) ** 3
    return np.where(listed(neighbour_count, neighbour_index), W1, 0.0)


def bubble_drag(
    position, phase, bubble_index, bubble_count, bubble_radius, support_radius, neighbour_count, neighbour_index,
    pbf, bubbles, dt, velocity, bubble_push,
):
    """Slow bubbles down towards the liquid around them, and write what the liquid gets for it.

    Reads: position (3, n) [m], phase (n,), bubble_index (n,) of which the first bubble_count[0] count, bubble_radius
        (n,) [m], support_radius (n,) [m] (effect precision only), neighbour lists; velocity of liquid [m/s].
    Writes: of the listed, velocity (3, n) [m/s] and bubble_push (3, n) = -I_b dv_b/S_W [kg m^4/s]; those without
        liquid around, or that move with it, keep their velocity and push nothing. A bubble of more than 0.75 R
        has pushed the liquid out of its support (`bubble_exclude`), or carries along what is left there: it is slowed as in
        liquid at rest, and what it loses goes to nobody (with no such rule bubbles of 2.5 d rose at 3.4 m/s, 5 times sqrt(g r)).
    """
    W1 = np.where(phase == 0, _weights(position, support_radius, neighbour_count, neighbour_index, pbf), 0.0)
    dt, v = float(dt), velocity.astype(np.float64)
    for b in _listed(bubble_index, bubble_count):
        bubble_push[:, b] = 0
        SW, r = W1[b].sum(), float(bubble_radius[b])
        still = r > 0.75 * float(pbf.support)
        if SW == 0 and not still:
            continue
        w = v[:, b] if still else (W1[b] * (v[:, b, None] - v)).sum(axis=1) / SW  # v_b - u_b
        s0 = np.sqrt((w**2).sum())
        if s0 == 0:
            continue
        k = float(bubbles.drag) / r
        s1 = 2 * s0 / (1 + np.sqrt(1 + 4 * k * dt * s0))  # the root of k dt s1^2 + s1 = s0
        dv = -w * k * dt * s1**2 / s0
        I_b = float(bubbles.inertia) * 4 / 3 * np.pi * r**3
        velocity[:, b] = v[:, b] + dv
        bubble_push[:, b] = 0 if still else -I_b * dv / SW


def bubble_reaction(
    position, phase, mass, support_radius, bubble_push, neighbour_count, neighbour_index, pbf, velocity,
):
    """Add to the velocity of liquid what the bubbles around hand to it, dv_j = sum_b W_bj push_b/m_j.

    Reads: position (3, n) [m], phase (n,), mass (n,) [kg], support_radius (n,) [m] (effect precision only),
        bubble_push (3, n) [kg m^4/s] of bubbles, neighbour lists.
    Writes: velocity (3, n) [m/s] of liquid; others keep theirs.
    """
    W1 = _weights(position, support_radius, neighbour_count, neighbour_index, pbf)
    for j in np.flatnonzero(phase == 0):
        around = np.flatnonzero((W1[j] > 0) & (phase == 3))
        push = (W1[j, around] * bubble_push[:, around].astype(np.float64)).sum(axis=1)
        velocity[:, j] = velocity[:, j].astype(np.float64) + push / float(mass[j])


def bubble_move(bubble_index, bubble_count, bubble_radius, velocity, position_predicted, bubbles, dt, position):
    """Put bubbles where their velocity after the drag takes them, x = x^n + dt v, within the walls.

    Reads: bubble_index (n,) of which the first bubble_count[0] count, bubble_radius (n,) [m], velocity (3, n)
        [m/s], position_predicted (3, n) [m], which holds x^n of bubbles. Writes: position (3, n) [m] of the listed.
    """
    on = _listed(bubble_index, bubble_count)
    x = position_predicted[:, on].astype(np.float64) + float(dt) * velocity[:, on].astype(np.float64)
    position[:, on] = _inside(x, bubble_radius[on].astype(np.float64), bubbles)


def bubble_drift(
    position, phase, bubble_index, bubble_count, neighbour_count, neighbour_index, bubbles, dt, bubble_shift,
):
    """Write how far bubbles drift towards the side where more others are, eq (13).

    Those at an equal coordinate count on neither side. Bounded by ``drift dt`` if normalised; else, the sum over
    bubbles that stand in each other's lists is 0.

    Reads: position (3, n) [m], phase (n,), bubble_index (n,) of which the first bubble_count[0] count, lists.
    Writes: bubble_shift (2, n) [m] of the listed.
    """
    step = float(bubbles.drift) * float(dt)
    for b in _listed(bubble_index, bubble_count):
        near = neighbour_index[b, : neighbour_count[b]]
        others = near[phase[near] == 3]
        for axis in range(2):
            more, less = ((s * (position[axis, others] - position[axis, b]) > 0).sum() for s in (1, -1))
            share = more - less  # X+ - X-
            if bubbles.normalised == 1:
                share = share / max(more + less, 1)
            bubble_shift[axis, b] = step * share  # (13)


def bubble_shift(bubble_index, bubble_count, bubble_radius, bubble_shift, bubbles, position):
    """Add the drift to the horizontal place of bubbles, within the walls; it does not enter their velocity.

    Reads: bubble_index (n,) of which the first bubble_count[0] count, bubble_radius (n,) and bubble_shift (2, n) [m].
    Writes: position (3, n) [m] of the listed, x and y.
    """
    on = _listed(bubble_index, bubble_count)
    x = position[:, on].astype(np.float64)
    x[:2] += bubble_shift[:, on].astype(np.float64)
    position[:2, on] = _inside(x, bubble_radius[on].astype(np.float64), bubbles)[:2]


def bubble_avoid(phase, bubble_index, bubble_count, bubble_radius, neighbour_count, neighbour_index, bubbles, position):
    """Move bubbles out of solids, by the mean of what each solid particle closer than r_b + d/2 asks for.

    Bubbles are not moved by the density solve: without this they would rise through a body. It does not enter their
    velocity: under a body they stay as fast as liquid lets them rise, and come to its rim with the liquid.

    Reads: phase (n,), bubble_index (n,) of which the first bubble_count[0] count, bubble_radius (n,) [m], lists.
    Writes: position (3, n) [m] of the listed, within the walls.
    """
    start = position.astype(np.float64)
    for b in _listed(bubble_index, bubble_count):
        near = neighbour_index[b, : neighbour_count[b]]
        away = start[:, [b]] - start[:, near[phase[near] == 1]]
        r = np.sqrt((away**2).sum(axis=0))
        reach = float(bubble_radius[b]) + 0.5 * float(bubbles.spacing)
        touch = (r < reach) & (r > 1e-9 * float(bubbles.spacing))
        if touch.any():
            shift = ((reach / r[touch] - 1) * away[:, touch]).mean(axis=1)
            position[:, b] = _inside((start[:, b] + shift)[:, None], float(bubble_radius[b]), bubbles)[:, 0]
