"""Left-balanced KD-tree and neighbour lists from it. Melting spec 2.9 (the paper's search)."""

import numpy as np

from melt.reference._near import write_near


def kdtree_build(position, tree, tree_rank):
    """Write the implicit left-balanced KD-tree: node k has the children 2k + 1 and 2k + 2.

    At level l a subtree is sorted by coordinate l mod 3 (ties by index, NaN last); its root
    is the element that leaves a complete tree, filled from the left, on either side.

    Reads: position (3, n) [m], inactive particles included.
    Writes: tree (n,), the particle at each node; tree_rank (n,) is scratch.
    """

    def build(node, level, members):
        if members.size == 0:
            return
        members = members[np.lexsort((members, position[level % 3, members]))]
        levels = int(members.size).bit_length()
        lowest = members.size - (2 ** (levels - 1) - 1)  # nodes of the last level
        half = 2 ** (levels - 2) if levels > 1 else 0  # of them at most left of the root
        left = max(half - 1, 0) + min(lowest, half)
        tree[node] = members[left]
        build(2 * node + 1, level + 1, members[:left])
        build(2 * node + 2, level + 1, members[left + 1:])

    build(0, 0, np.arange(position.shape[1]))


def neighbours_kdtree(position, phase, tree, smoothing, neighbour_count, neighbour_index):
    """Write the same lists as `melt.reference.neighbours.neighbours_grid`.

    Reads: position (3, n) [m] in any order, phase (n,), tree (n,) (not used: all pairs).
    Writes: neighbour_count (n,), neighbour_index (n, capacity).
    """
    write_near(position, phase, smoothing, neighbour_count, neighbour_index)
