"""CUDA twin of `melt.reference.kdtree`.

The build sorts every subtree of a level at once, by merging: each element finds its place
in the merged run by a binary search in the other run, so passes need no barrier and the
result does not depend on the order of threads. n particles take about log2(n)^2 / 2 launches.
"""

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import INACTIVE, WALL
from melt.physics.search import precedes, segment_of, squared_distance

RUN = 16  # elements that the first pass sorts by counting
GAPS = (57, 23, 10, 4, 1)  # of the Shell sort of a list


@cuda_kernel
def _identity(order):
    p = cuda.grid(1)
    if p < order.shape[0]:
        order[p] = p


@cuda_kernel
def _sort_runs(position, level, source, target):
    p = cuda.grid(1)
    n = source.shape[0]
    if p >= n:
        return
    first, size, node = segment_of(p, level, n)
    start = first + (p - first) // RUN * RUN
    stop = min(start + RUN, first + size)
    i = source[p]
    x_i = position[level % 3, i]
    place = start
    for q in range(start, stop):
        j = source[q]
        if precedes(position[level % 3, j], j, x_i, i):
            place += 1
    target[place] = i


@cuda_kernel
def _merge_runs(position, level, width, source, target):
    p = cuda.grid(1)
    n = source.shape[0]
    if p >= n:
        return
    first, size, node = segment_of(p, level, n)
    i = source[p]
    x_i = position[level % 3, i]
    run = (p - first) // width
    other = run ^ 1
    start = min(other * width, size)
    low, high = start, min(start + width, size)
    while low < high:
        middle = (low + high) // 2
        j = source[first + middle]
        if precedes(position[level % 3, j], j, x_i, i):
            low = middle + 1
        else:
            high = middle
    place = min(run, other) * width + (p - first - run * width) + (low - start)
    target[first + place] = i


@cuda_kernel
def _to_nodes(levels, order, tree):
    p = cuda.grid(1)
    if p < order.shape[0]:
        first, size, node = segment_of(p, levels, order.shape[0])
        tree[node] = order[p]


def kdtree_build(position, tree, tree_rank):
    """See `melt.reference.kdtree.kdtree_build`."""
    n = tree.shape[0]
    levels = int(n).bit_length()
    source, target = tree, tree_rank
    _identity.launch(n, source)
    for level in range(levels):
        largest = 2 ** (levels - level) - 1  # subtree of the level
        _sort_runs.launch(n, position, level, source, target)
        source, target = target, source
        width = RUN
        while width < largest:
            _merge_runs.launch(n, position, level, width, source, target)
            source, target = target, source
            width *= 2
    if source is tree:  # subtrees of the last level have one element: this copies
        _sort_runs.launch(n, position, levels, source, target)
    _to_nodes.launch(n, levels, tree_rank, tree)


@cuda_kernel
def _neighbours_kdtree(position, phase, tree, smoothing, neighbour_count, neighbour_index):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    neighbour_count[i] = 0
    if phase[i] == WALL or phase[i] == INACTIVE:
        return
    real = type(smoothing.support)
    h = smoothing.support
    h2 = h * h
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    n = tree.shape[0]
    capacity = neighbour_index.shape[1]
    count = level = node = 0
    came = -1  # the node before this one: its parent on the way down, a child on the way up
    while node >= 0:
        j = tree[node]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        parent = (node + 1) // 2 - 1
        if came == parent:
            if squared_distance(x, y, z) < h2 and j != i and phase[j] != INACTIVE:
                if count < capacity:
                    neighbour_index[i, count] = j
                elif capacity > 0:  # keep the smallest ones
                    worst = 0
                    for k in range(1, capacity):
                        if neighbour_index[i, k] > neighbour_index[i, worst]:
                            worst = k
                    if j < neighbour_index[i, worst]:
                        neighbour_index[i, worst] = j
                count += 1
        axis = level % 3
        d = x if axis == 0 else (y if axis == 1 else z)
        left, right = 2 * node + 1, 2 * node + 2
        # "not >=" visits both sides of a NaN; rounding is monotone, so no pair is missed
        go_left = came == parent and left < n and not (d >= h)
        go_right = came != right and not go_left and right < n and not (-d >= h)
        came = node
        if go_left:
            node = left
            level += 1
        elif go_right:
            node = right
            level += 1
        else:
            node = parent
            level -= 1
    neighbour_count[i] = count
    stored = min(count, capacity)
    for gap in GAPS:
        for a in range(gap, stored):
            value = neighbour_index[i, a]
            b = a
            while b >= gap and neighbour_index[i, b - gap] > value:
                neighbour_index[i, b] = neighbour_index[i, b - gap]
                b -= gap
            neighbour_index[i, b] = value


def neighbours_kdtree(position, phase, tree, smoothing, neighbour_count, neighbour_index):
    """See `melt.reference.kdtree.neighbours_kdtree`."""
    if tree.shape[0] > 0:
        _neighbours_kdtree.launch(
            phase.shape[0], position, phase, tree, smoothing, neighbour_count, neighbour_index,
        )
