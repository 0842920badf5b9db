"""Scalar formulas of rays over a height field. Flood spec 5, R0."""

import math

from melt._compile import scalar


@scalar
def enter(x, dx, y, dy, wide, deep):
    """Return (t, t) at which the line (x + dx t, y + dy t), t >= 0, enters and leaves 0 .. wide, 0 .. deep."""
    real = type(x)
    far = real(1e30)
    first, last = real(0), far
    if dx == real(0):
        last = last if real(0) <= x <= wide else real(-1)
    else:
        one, two = -x / dx, (wide - x) / dx
        first, last = max(first, min(one, two)), min(last, max(one, two))
    if dy == real(0):
        last = last if real(0) <= y <= deep else real(-1)
    else:
        one, two = -y / dy, (deep - y) / dy
        first, last = max(first, min(one, two)), min(last, max(one, two))
    return first, last


@scalar
def next_line(x, dx, cell):
    """Return t at which x + dx t leaves the interval cell .. cell + 1."""
    real = type(x)
    if dx == real(0):
        return real(1e30)
    return (real(cell + 1 if dx > real(0) else cell) - x) / dx


@scalar
def gap(x, dx, y, dy, z, dz, t, a, b, c, d):
    """Return the height of a ray at t above a bilinear cell with corners a (0, 0), b (1, 0), c (0, 1), d (1, 1)."""
    u, v = x + dx * t, y + dy * t
    low, high = a + u * (b - a), c + u * (d - c)
    return z + dz * t - (low + v * (high - low))


@scalar
def meet(entry, middle, exit):
    """Return the root in 0 .. 1 of the quadratic with these values at 0, 1/2, 1; entry > 0 >= exit."""
    real = type(entry)
    two, four = real(2), real(4)
    square, linear = two * (entry + exit) - four * middle, four * middle - real(3) * entry - exit
    return two * entry / (math.sqrt(max(linear * linear - four * square * entry, real(0))) - linear)
