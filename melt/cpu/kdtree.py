"""CPU twin of `melt.reference.kdtree`.

Measured at 59,319 particles, h/dx = 2.5, float32, one thread: build 12 ms (cell index and sort:
0.4 ms), lists 176 ms (grid: 5.5 ms).
"""

import numpy as np

from melt._compile import cpu_helper, cpu_serial, cpu_stage, prange
from melt.physics.phases import INACTIVE, WALL
from melt.physics.search import left_size, precedes, squared_distance

#: Levels built one after another, their subtrees in parallel; below, each of the 64 subtrees on its own.
TOP = 6


@cpu_serial
def _select(x, order, first, stop, place):
    """Reorder order[first:stop] so that the element of sorted rank ``place`` stands there.

    Quickselect with the middle one of three pivots; selecting gives the tree that sorting
    gives, because no two elements are equal (ties by index).
    """
    low, high = np.int64(first), np.int64(stop) - 1
    while low < high:
        a, b, c = order[low], order[(low + high) // 2], order[high]
        if precedes(x[b], b, x[a], a):
            a, b = b, a
        if precedes(x[c], c, x[b], b):
            b = c
            if precedes(x[b], b, x[a], a):
                b = a
        pivot, i, j = x[b], low, high
        while i <= j:
            while precedes(x[order[i]], order[i], pivot, b):
                i += 1
            while precedes(pivot, b, x[order[j]], order[j]):
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if place <= j:
            high = j
        elif place >= i:
            low = i
        else:
            return


@cpu_serial
def _subtree(position, order, tree, first, size, node, level):
    """Build the subtree of places first .. first + size - 1 below a node."""
    todo = np.empty((64, 4), np.int64)
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = first, size, node, level
    top = 1
    while top > 0:
        top -= 1
        first, size, node, level = todo[top, 0], todo[top, 1], todo[top, 2], todo[top, 3]
        while size > 0:
            left = left_size(size)
            _select(position[level % 3], order, first, first + size, first + left)
            tree[node] = order[first + left]
            level += 1
            todo[top, 0], todo[top, 1], todo[top, 2], todo[top, 3] = (
                first + left + 1, size - left - 1, 2 * node + 2, level)
            top += 1
            size, node = left, 2 * node + 1


@cpu_helper
def _node_segment(node, level, n):
    """Return the first place and the size of the subtree of a node of a level."""
    first, size = 0, n
    for bit in range(level - 1, -1, -1):
        left = left_size(size)
        if ((node + 1) >> bit) & 1:
            first, size = first + left + 1, size - left - 1
        else:
            size = left
    return first, size


@cpu_stage
def kdtree_build(position, tree, tree_rank):
    """See `melt.reference.kdtree.kdtree_build`. A subtree is a range of ``tree_rank``."""
    n = tree.shape[0]
    for p in prange(n):
        tree_rank[p] = p
    for level in range(TOP):
        base = (1 << level) - 1
        for k in prange(min(1 << level, max(n - base, 0))):
            first, size = _node_segment(base + k, level, n)
            place = first + left_size(size)
            _select(position[level % 3], tree_rank, first, first + size, place)
            tree[base + k] = tree_rank[place]
    base = (1 << TOP) - 1
    for k in prange(min(1 << TOP, max(n - base, 0))):
        first, size = _node_segment(base + k, TOP, n)
        _subtree(position, tree_rank, tree, first, size, base + k, TOP)


@cpu_helper
def _sort_row(row, count, copy):
    """Sort by counting the smaller entries of each one: vectorised, a third of a Shell sort's time."""
    n = np.uint64(count)
    for a in range(n):
        copy[a] = row[a]
    for a in range(n):
        value, place = copy[a], np.int32(0)
        for b in range(n):
            place += np.int32(copy[b] < value)
        row[np.uint64(place)] = value


@cpu_helper
def _keep_smallest(row, j):
    """Replace the largest entry of a full row by j if j is smaller."""
    worst = 0
    for k in range(1, row.shape[0]):
        if row[k] > row[worst]:
            worst = k
    if row.shape[0] > 0 and j < row[worst]:
        row[worst] = j


@cpu_serial
def _query(position, phase, tree, smoothing, i, pending, depth, row):
    """Write the neighbours of i to ``row`` in no order, return their number."""
    real = type(smoothing.support)
    h = smoothing.support
    h2 = h * h
    n, top, count, node, level = tree.shape[0], 0, 0, 0, 0
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    while True:
        j = tree[node]
        x, y, z = real(x_i - position[0, j]), real(y_i - position[1, j]), real(z_i - position[2, j])
        if squared_distance(x, y, z) < h2 and j != i and phase[j] != INACTIVE:
            if count < row.shape[0]:
                row[count] = j
            else:
                _keep_smallest(row, j)
            count += 1
        axis = level % 3
        d = x if axis == 0 else (y if axis == 1 else z)
        # "not >=" visits both sides of a NaN; rounding is monotone, so no pair is missed
        left = 2 * node + 1 < n and not (d >= h)
        right = 2 * node + 2 < n and not (-d >= h)
        level += 1
        if left:
            if right:
                pending[top], depth[top] = 2 * node + 2, level
                top += 1
            node = 2 * node + 1
        elif right:
            node = 2 * node + 2
        elif top > 0:
            top -= 1
            node, level = pending[top], depth[top]
        else:
            return count


@cpu_stage
def neighbours_kdtree(position, phase, tree, smoothing, neighbour_count, neighbour_index):
    """See `melt.reference.kdtree.neighbours_kdtree`."""
    n = np.int64(phase.shape[0])
    for chunk in prange(64):
        pending, depth = np.empty(64, np.int64), np.empty(64, np.int64)
        copy = np.empty(neighbour_index.shape[1], np.int32)
        piece = (chunk * 37) % 64
        for i in range(n * piece // 64, n * (piece + 1) // 64):
            count = 0
            if phase[i] != WALL and phase[i] != INACTIVE:
                row = neighbour_index[i]
                count = _query(position, phase, tree, smoothing, i, pending, depth, row)
                _sort_row(row, min(count, row.shape[0]), copy)
            neighbour_count[i] = count
