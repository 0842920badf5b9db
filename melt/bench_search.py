"""Cost of the two neighbour searches on the CPU, alone: grid against KD-tree, ns per pair."""

import time

import numpy as np

from melt import params as P
from melt.cpu import grid, kdtree, neighbours

#: Type of positions, type of everything else.
PRECISIONS = {
    "single": (np.float32, np.float32),
    "mixed": (np.float64, np.float32),
    "double": (np.float64, np.float64),
}


def _ms(call, repeats):
    call()  # compiles
    samples = []
    for _ in range(repeats):
        began = time.perf_counter()
        call()
        samples.append(1e3 * (time.perf_counter() - began))
    return float(np.median(samples)), min(samples)


def search_costs(particles, precision="single", ratio=2.5, capacity=160, repeats=9):
    """Time each search stage on a jittered cubic lattice of about ``particles`` liquid particles.

    Args:
        ratio: support over spacing.

    Returns:
        dict: ``particles``, ``pairs`` (directed), ``ms`` {stage: (median, best)}, and the ratios
        ``ns_per_pair`` (grid lists, best), ``tree_build`` and ``tree_search`` (KD-tree over grid, best).

    Raises:
        RuntimeError: the two searches disagree, or a list exceeds the capacity.
    """
    wide, real = PRECISIONS[precision]
    edge = max(2, round(particles ** (1 / 3)))
    rng = np.random.default_rng(0)
    lattice = np.stack(np.meshgrid(*[np.arange(edge)] * 3, indexing="ij")).reshape(3, -1)
    shuffled = (lattice + 0.5 + rng.uniform(-0.1, 0.1, lattice.shape)).astype(wide)
    n, cells = lattice.shape[1], int(np.ceil(edge / (ratio * 1.0001)))
    box = P.make(
        P.Grid, real, origin_x=0, origin_y=0, origin_z=0, inverse_cell=1 / (ratio * 1.0001),
        nx=cells, ny=cells, nz=cells,
    )
    smoothing = P.make(P.Smoothing, real, support=ratio, kernel=P.CUBIC, laplacian=P.L_VISC)
    phase = np.zeros(n, np.int32)
    cell, order, scratch, tree, count = (np.empty(n, np.int32) for _ in range(5))
    start, index = np.empty(cells**3 + 2, np.int32), np.zeros((n, capacity), np.int32)
    position = np.empty_like(shuffled)
    ms = {
        "cell_index": _ms(lambda: grid.cell_index(shuffled, phase, box, cell), repeats),
        "cell_sort": _ms(lambda: grid.cell_sort(cell, order, start, scratch, scratch), repeats),
        "reorder_vector": _ms(lambda: grid.reorder_vector(order, shuffled, position), repeats),
        "neighbours_grid": _ms(
            lambda: neighbours.neighbours_grid(position, phase, start, box, smoothing, count, index), repeats
        ),
    }
    of_grid = count.copy(), index.copy()
    few = max(1, repeats // 3)
    ms["kdtree_build"] = _ms(lambda: kdtree.kdtree_build(position, tree, scratch), few)
    ms["neighbours_kdtree"] = _ms(
        lambda: kdtree.neighbours_kdtree(position, phase, tree, smoothing, count, index), few
    )
    if count.max() > capacity:
        raise RuntimeError(f"a particle has {count.max()} neighbours, the capacity is {capacity}: raise it")
    if not (np.array_equal(of_grid[0], count) and np.array_equal(of_grid[1], index)):
        raise RuntimeError("grid and KD-tree return different lists: run `melt check neighbours_kdtree`")
    pairs = int(count.sum())
    return {
        "particles": n,
        "pairs": pairs,
        "ms": ms,
        "ns_per_pair": 1e6 * ms["neighbours_grid"][1] / max(1, pairs),
        "tree_build": ms["kdtree_build"][1] / (ms["cell_index"][1] + ms["cell_sort"][1]),
        "tree_search": ms["neighbours_kdtree"][1] / ms["neighbours_grid"][1],
    }
