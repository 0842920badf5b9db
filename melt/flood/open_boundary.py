r"""Open boundaries by characteristics. Flood spec E18.

Velocities are along n, the unit vector from the edge *into* the water. Of the two invariants,
:math:`v - 2c` travels against n at :math:`v - c` and carries what the water inside says out to the edge,
:math:`v + 2c` travels along n and carries in what the boundary says (c = sqrt(g d)). So

.. math:: v_B - 2 c_B = v_I - 2 c_I =: K

and the boundary gives one number more. With an imposed velocity
:math:`\sqrt{d_B} = \sqrt{d_I} + (v_B - v_I)/(2\sqrt g)`, with an imposed depth
:math:`v_B = v_I - 2\sqrt g(\sqrt{d_I} - \sqrt{d_B})`, with an imposed discharge per width the root of
:math:`c_B^2 (K + 2 c_B) = g q`, with a state far away both invariants, which lets waves leave.

That holds while :math:`|v_B| \le c_B`. Beyond, one number cannot be imposed: water that leaves faster than its waves is
copied; where the formula would have it leave, or enter, faster than that, it does so at the critical speed (a free fall;
a dry bed that fills); water that enters faster needs depth and velocity, both imposed.
"""

import math
from typing import NamedTuple

from melt.errors import InputError


class BoundaryState(NamedTuple):
    """Water at the edge."""

    depth: float  # [m]
    velocity: float  # along the inward normal [m/s]
    regime: str  # subcritical, critical in, critical out, supercritical in, supercritical out

    @property
    def discharge(self):
        """Discharge per width, inwards [m^2/s]."""
        return self.depth * self.velocity


def boundary_state(inside_depth, inside_velocity, depth=None, velocity=None, discharge=None, far=None, gravity=9.81):
    """Return the `BoundaryState` of an edge whose water inside has a depth [m] and an inward velocity [m/s].

    Args:
        depth, velocity, discharge: one of them [m, m/s, m^2/s, inwards]; depth with one of the others imposes both
            where the water enters faster than its waves, and the depth elsewhere.
        far: (depth, velocity) of the water far outside: waves from inside leave.

    Raises:
        InputError: nothing imposed, too much, or a number that is not finite or a negative depth.
    """
    given = {k: v for k, v in dict(depth=depth, velocity=velocity, discharge=discharge).items() if v is not None}
    numbers = [inside_depth, inside_velocity, *given.values(), *(far or ())]
    if not all(map(math.isfinite, numbers)) or inside_depth < 0 or (depth or 0.0) < 0 or (far and far[0] < 0):
        raise InputError(f"open boundary: {given or far} beside water of {inside_depth:g} m at {inside_velocity:g} m/s: "
                         "depths must be positive, and all numbers finite")
    if (far is None) == (not given) or {"velocity", "discharge"} <= set(given):
        raise InputError("open boundary: impose a depth, a velocity or a discharge, a depth and one of them, or a state far away")
    g = float(gravity)
    if far is not None:
        return _absorbed(inside_depth, inside_velocity, *far, g)
    if inside_velocity < 0 and inside_velocity < -math.sqrt(g * inside_depth):
        return BoundaryState(inside_depth, inside_velocity, "supercritical out")
    if depth is not None:
        speed = velocity if discharge is None else discharge / depth if depth > 0 else 0.0
        if speed is not None and speed > math.sqrt(g * depth):
            return BoundaryState(depth, speed, "supercritical in")
        return _from_depth(_leaving(inside_depth, inside_velocity, g), depth, g)
    K = _leaving(inside_depth, inside_velocity, g)
    return _from_velocity(K, velocity, g) if velocity is not None else _from_discharge(K, discharge, g)


def _leaving(depth, velocity, g):
    """Return K = v - 2 c, the invariant that leaves."""
    return velocity - 2 * math.sqrt(g * depth)


def _critical_out(K, g):
    """Return the state in which water with the invariant K falls freely over the edge: v = -c."""
    c = max(-K / 3, 0.0)
    return BoundaryState(c * c / g, -c, "critical out")


def _from_depth(K, depth, g):
    c = math.sqrt(g * depth)
    v = K + 2 * c
    if v < -c:
        return _critical_out(K, g)
    if v > c:
        return BoundaryState(depth, c, "critical in")
    return BoundaryState(depth, v, "subcritical")


def _from_velocity(K, v, g):
    c = 0.5 * (v - K)
    if v < -c:  # more than the water inside gives
        return _critical_out(K, g)
    if v > c:
        return BoundaryState(v * v / g, v, "critical in")
    return BoundaryState(c * c / g, v, "subcritical")


def _from_discharge(K, q, g):
    """Solve c^2 (K + 2 c) = g q by Newton steps from above the largest root, where the left side is convex and grows."""
    critical = (g * abs(q)) ** (1 / 3)
    least = max(-K / 3, 0.0)
    if q < 0 and least * least * (K + 2 * least) >= g * q:
        return _critical_out(K, g)  # all that the water inside gives, and less than q
    if q > 0 and K + 2 * critical >= critical:
        return BoundaryState(critical**2 / g, critical, "critical in")
    c = max(-K, 0.0) + critical
    for _ in range(100):
        step = (c * c * (K + 2 * c) - g * q) / (c * (6 * c + 2 * K)) if c > 0 else 0.0
        c -= step
        if abs(step) <= 1e-15 * c:
            break
    d = c * c / g
    return BoundaryState(d, q / d if d > 0 else 0.0, "subcritical")


def _absorbed(depth, velocity, far_depth, far_velocity, g):
    """Both invariants: what leaves from inside, what enters from far away."""
    if velocity < 0 and velocity < -math.sqrt(g * depth):
        return BoundaryState(depth, velocity, "supercritical out")
    far_c = math.sqrt(g * far_depth)
    if far_velocity > far_c:
        return BoundaryState(far_depth, far_velocity, "supercritical in")
    K, entering = _leaving(depth, velocity, g), far_velocity + 2 * far_c
    v, c = 0.5 * (K + entering), 0.25 * (entering - K)
    if v < -c or c < 0:
        return _critical_out(K, g)
    if v > c:
        c = entering / 3
        return BoundaryState(c * c / g, c, "critical in")
    return BoundaryState(c * c / g, v, "subcritical")


def inside_of(area, flow, volume):
    """Return (depth [m], inward velocity [m/s]) of the water in a probe from its `zone_sums`; (0, 0) where it is dry."""
    return (volume / area, flow / volume) if area > 0 and volume > 0 else (0.0, 0.0)
