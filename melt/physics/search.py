"""Scalar formulas of the neighbour search. Melting spec 2.9.

All are `scalar`: the comparison with the support is rounded the same way in every loop that
calls it, so the grid and the KD-tree of one twin return identical lists even for pairs at the
support to the last bit (lattices have many).
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
    """Return x^2 + y^2 + z^2, added in this order; nothing is fused on the CPU, NVVM fuses on a device."""
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
def segment_of(place, level, n):
    """Return (first, size, node) of the subtree at a level that holds a place in the in-order sequence.

    Places 0 .. n-1 are those of the nodes from left to right; a subtree holds a contiguous
    range of them. A place that is a node above the level is returned as a segment of its own.
    """
    first, size, node = 0, n, 0
    for _ in range(level):
        left = left_size(size)
        if place < first + left:
            size, node = left, 2 * node + 1
        elif place > first + left:
            first, size, node = first + left + 1, size - left - 1, 2 * node + 2
        else:
            return place, 1, node
    return first, size, node


@scalar
def precedes(x, i, y, j):
    """Return whether particle i at coordinate x sorts before j at y: NaN last, ties by index."""
    if x < y:
        return True
    if y < x:
        return False
    if x == y or (x != x and y != y):
        return i < j
    return x == x  # y is NaN
