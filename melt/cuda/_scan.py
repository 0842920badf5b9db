"""Prefix sums and stable compaction in three launches each, without barriers.

A thread walks one chunk of `CHUNK` elements, one thread sums up the chunks, and the chunks
are walked again. Results do not depend on the order of threads.
"""

from melt._compile import cuda, cuda_kernel

CHUNK = 256


def chunks(n):
    """Return the number of chunks of n elements."""
    return -(-n // CHUNK)


@cuda_kernel
def _chunk_sums(values, chunk_sum):
    c = cuda.grid(1)
    first = c * CHUNK
    if first >= values.shape[0]:
        return
    total = 0
    for k in range(first, min(first + CHUNK, values.shape[0])):
        total += values[k]
    chunk_sum[c] = total


@cuda_kernel
def _scan_sums(n, chunk_sum):
    """Turn the first n chunk sums into what precedes each chunk (one thread)."""
    if cuda.grid(1) > 0:
        return
    total = 0
    for c in range(n):
        value = chunk_sum[c]
        chunk_sum[c] = total
        total += value


@cuda_kernel
def _add_offsets(chunk_sum, values):
    c = cuda.grid(1)
    first = c * CHUNK
    if first >= values.shape[0]:
        return
    total = chunk_sum[c]
    for k in range(first, min(first + CHUNK, values.shape[0])):
        total += values[k]
        values[k] = total


@cuda_kernel
def _count_equal(keys, key, chunk_sum):
    c = cuda.grid(1)
    first = c * CHUNK
    if first >= keys.shape[0]:
        return
    total = 0
    for k in range(first, min(first + CHUNK, keys.shape[0])):
        if keys[k] == key:
            total += 1
    chunk_sum[c] = total


@cuda_kernel
def _place_equal(keys, key, chunk_sum, start, target):
    c = cuda.grid(1)
    first = c * CHUNK
    if first >= keys.shape[0]:
        return
    place = start[key] + chunk_sum[c]
    for k in range(first, min(first + CHUNK, keys.shape[0])):
        if keys[k] == key:
            target[place] = k
            place += 1


def inclusive_scan(values, chunk_sum):
    """Replace values (m,) by their running sums; chunk_sum holds at least `chunks(m)`."""
    n = chunks(values.shape[0])
    _chunk_sums.launch(n, values, chunk_sum)
    _scan_sums.launch(min(n, 1), n, chunk_sum)
    _add_offsets.launch(n, chunk_sum, values)


def place_equal(keys, key, start, chunk_sum, target):
    """Write the indices k with keys[k] == key, ascending, to target from start[key] on."""
    n = chunks(keys.shape[0])
    _count_equal.launch(n, keys, key, chunk_sum)
    _scan_sums.launch(min(n, 1), n, chunk_sum)
    _place_equal.launch(n, keys, key, chunk_sum, start, target)
