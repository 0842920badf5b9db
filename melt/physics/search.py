"""Scalar formulas of the neighbour search. Melting spec 2.9.

Compiled without fastmath: the comparison with the support is rounded the same way in every
loop that calls it, so the grid and the KD-tree of one twin return identical lists even for
pairs at the support to the last bit (lattices have many).
"""

from melt._compile import scalar


@scalar
def axis_cell(x, origin, inverse_cell, count):
    """Return the cell 0 .. count-1 of coordinate x along one axis; those outside are clamped.

    Clamped as a floating-point number: converting 1e9 / cell or NaN to an integer is
    undefined. NaN goes to cell 0. Clamping never separates neighbours, because it never
    increases the difference of two cell numbers.
    """
    wide = type(x)
    t = (x - wide(origin)) * wide(inverse_cell)
    if t >= wide(count - 1):
        return int(count) - 1
    if t > wide(0):
        return int(t)
    return 0


@scalar
def squared_distance(x, y, z):
    """Return x^2 + y^2 + z^2, added in this order without fused operations."""
    return x * x + y * y + z * z


@scalar
def left_size(n):
    """Return the number of nodes left of the root in a left-balanced binary tree of n >= 1 nodes."""
    full = 1  # nodes of the lowest full level, 2^l <= (n + 1) / 2
    while 4 * full - 1 <= n:
        full *= 2
    # complete levels hold 2 full - 1 nodes, the last one gets what is left, filled from the left
    return full - 1 + min(n - (2 * full - 1), full)


@scalar
def sort_key(x):
    """Return x, or infinity for NaN: the KD-tree needs a total order."""
    return x if x == x else type(x)(float("inf"))
