"""CPU twin of `melt.reference.lists`."""

import numpy as np

from melt._compile import cpu_serial


@cpu_serial
def list_slots(flag, key, index, count, chunk_sum):
    """See `melt.reference.lists.list_slots`; `chunk_sum` is used by the CUDA twin only."""
    found = np.uint64(0)
    for i in range(np.uint64(flag.shape[0])):
        if flag[i] == key:
            index[found] = np.int32(i)
            found += np.uint64(1)
    count[0] = np.int32(found)


@cpu_serial
def order_by_id(id, count, index, list_scratch):
    """See `melt.reference.lists.order_by_id`: sorted runs of twice the length in every pass."""
    n = count[0]
    width = 1
    while width < n:
        for first in range(0, n, 2 * width):
            middle, stop = min(first + width, n), min(first + 2 * width, n)
            left, right = first, middle
            for place in range(first, stop):
                if right == stop or (left < middle and id[index[left]] < id[index[right]]):
                    list_scratch[place] = index[left]
                    left += 1
                else:
                    list_scratch[place] = index[right]
                    right += 1
        for place in range(n):
            index[place] = list_scratch[place]
        width *= 2
