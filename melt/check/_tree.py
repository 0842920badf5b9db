"""Left-balanced implicit KD-tree of the check inputs, built recursively."""

import numpy as np


def left_size(count):
    """Return how many of ``count`` nodes the left subtree of a left-balanced tree holds."""
    if count < 2:
        return 0
    levels = (count + 1).bit_length() - 1  # full levels
    full = 2**levels - 1
    rest = count - full
    return (full - 1) // 2 + min(rest, 2 ** (levels - 1))


def left_balanced(position):
    """Return the particle at each node (n,): children 2k+1 and 2k+2, axis = level mod 3, ties by index."""
    n = position.shape[1]
    tree = np.zeros(n, int)
    todo = [(0, 0, np.arange(n))]
    while todo:
        node, level, members = todo.pop()
        if len(members) == 0:
            continue
        members = members[np.lexsort((members, position[level % 3, members]))]
        left = left_size(len(members))
        tree[node] = members[left]
        todo += [(2 * node + 1, level + 1, members[:left]), (2 * node + 2, level + 1, members[left + 1 :])]
    return tree
