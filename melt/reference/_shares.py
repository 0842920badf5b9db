"""Rows of a neighbour list, and the 64 shares of fixed-shape reductions."""

import numpy as np

SHARES = 64


def rows(neighbour_count, neighbour_index):
    """Yield (i, neighbours of i)."""
    for i, count in enumerate(np.asarray(neighbour_count)):
        yield i, np.asarray(neighbour_index)[i, :count]


def shares(values):
    """Return the pieces of ``values`` that the partial results of a reduction cover."""
    n = len(values)
    return [values[k * n // SHARES:(k + 1) * n // SHARES] for k in range(SHARES)]
