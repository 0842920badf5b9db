"""Driven edges: what the outgoing characteristic of the water inside leaves to choose. Flood spec E18.

With n the inward normal, v = v . n and c = sqrt(g d), the invariant that leaves the domain is v - 2 c: it has the
value of the water inside. A wave that arrives leaves, since only the incoming invariant v + 2 c is given.
"""

import math


def from_depth(wanted, inside_depth, inside_speed, g):
    """Return (depth [m], inward speed [m/s]) at an edge with a given depth.

    v_B = v_I - 2 (c_I - c_B). Where the water leaves faster than waves travel nothing can be given: it is copied.
    """
    c_I = math.sqrt(g * max(inside_depth, 0.0))
    if inside_speed < -c_I:
        return inside_depth, inside_speed
    c_B = math.sqrt(g * max(wanted, 0.0))
    return wanted, inside_speed - 2 * (c_I - c_B)


def from_discharge(wanted, inside_depth, inside_speed, g):
    """Return (depth [m], inward speed [m/s]) at an edge with a given discharge per width q [m^2/s], q >= 0.

    v_B d_B = q with v_B - 2 c_B = v_I - 2 c_I, solved for c_B by bisection (the left side grows with c_B where the
    inflow is slower than waves; otherwise depth and speed are both free, and the critical ones are taken).
    """
    if wanted <= 0:
        return inside_depth, 0.0
    critical = (wanted * wanted / g) ** (1 / 3)
    leaving = inside_speed - 2 * math.sqrt(g * max(inside_depth, 0.0))
    low, high = critical, max(critical, inside_depth, 1e-9)
    while wanted / high - 2 * math.sqrt(g * high) > leaving and high < 1e6 * critical:
        high *= 2
    if wanted / low - 2 * math.sqrt(g * low) <= leaving:
        return critical, wanted / critical
    for _ in range(80):
        middle = 0.5 * (low + high)
        if wanted / middle - 2 * math.sqrt(g * middle) > leaving:
            low = middle
        else:
            high = middle
    return high, wanted / high
