"""Lists of the forces between columns, cut and padded for vector loops."""

import numpy as np

from melt._compile import cpu_helper

#: Rows are padded to a multiple of this: vectors of 8 reals without a remainder, which would cost as much as the rest.
LANES = 8


@cpu_helper
def padded_row(i, neighbour_count, neighbour_index, row):
    """Copy the list of i to ``row``, fill it up with i itself; return the length of the list and that of the row."""
    count = min(np.int64(neighbour_count[i]), neighbour_index.shape[1])
    for k in range(np.uint64(count)):
        row[k] = neighbour_index[i, k]
    stop = (count + LANES - 1) // LANES * LANES
    for k in range(np.uint64(count), np.uint64(stop)):
        row[k] = i
    return count, stop
