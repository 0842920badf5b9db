"""CUDA twin of `melt.reference.lists`."""

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.cuda._scan import CHUNK, _count_equal, _scan_sums, chunks

#: Entries that are ranked by counting; longer lists are merged from runs of this length.
RUN = 1024


@cuda_kernel
def _clear(values):
    k = cuda.grid(1)
    if k < values.shape[0]:
        values[k] = 0


@cuda_kernel
def _place_slots(flag, key, chunk_sum, index, count):
    c = cuda.grid(1)
    first = c * CHUNK
    if first >= flag.shape[0]:
        return
    place = chunk_sum[c]
    for k in range(first, min(first + CHUNK, flag.shape[0])):
        if flag[k] == key:
            index[place] = k
            place += 1
    if first + CHUNK >= flag.shape[0]:
        count[0] = place


def list_slots(flag, key, index, count, chunk_sum):
    """See `melt.reference.lists.list_slots`; the length stays on the device."""
    n = chunks(flag.shape[0])
    _clear.launch(1, count)
    _count_equal.launch(n, flag, key, chunk_sum)
    _scan_sums.launch(min(n, 1), n, chunk_sum)
    _place_slots.launch(n, flag, key, chunk_sum, index, count)


@cuda_kernel
def _order_runs(id, count, source, target):
    """Sort each run: the place of an entry is the number of smaller ids in its run."""
    a = cuda.grid(1)
    if a >= count[0]:
        return
    first = a - a % RUN
    own = id[source[a]]
    place = first
    for b in range(first, min(first + RUN, count[0])):
        if id[source[b]] < own:
            place += 1
    target[place] = source[a]


@cuda_kernel
def _merge_runs(id, count, width, source, target):
    """Merge pairs of sorted runs: an entry moves on by what precedes it in the other run."""
    a = cuda.grid(1)
    if a >= count[0]:
        return
    first = a - a % (2 * width)
    middle, stop = min(first + width, count[0]), min(first + 2 * width, count[0])
    own = id[source[a]]
    low, high = (middle, stop) if a < middle else (first, middle)
    while low < high:
        m = (low + high) // 2
        if id[source[m]] < own:
            low = m + 1
        else:
            high = m
    target[a + low - middle] = source[a]


@cuda_kernel
def _copy(count, source, target):
    a = cuda.grid(1)
    if a < count[0]:
        target[a] = source[a]


def order_by_id(id, count, index, list_scratch):
    """See `melt.reference.lists.order_by_id`.

    The number of passes follows from the room of the list, as its length stays on the device: 11 for a million slots.
    """
    n = index.shape[0]
    _order_runs.launch(n, id, count, index, list_scratch)
    source, target = list_scratch, index
    width = RUN
    while width < n:
        _merge_runs.launch(n, id, count, np.int32(width), source, target)
        source, target = target, source
        width *= 2
    if source is list_scratch:
        _copy.launch(n, count, list_scratch, index)
