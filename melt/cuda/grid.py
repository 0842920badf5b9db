"""CUDA twin of `melt.reference.grid`."""

from melt._compile import cuda, cuda_kernel
from melt.cuda._scan import inclusive_scan, place_equal
from melt.physics.phases import INACTIVE, SOLID
from melt.physics.search import axis_cell


@cuda_kernel
def _cell_index(position, phase, grid, cell):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] == INACTIVE:
        cell[i] = grid.nx * grid.ny * grid.nz
        return
    x = axis_cell(position[0, i], grid.origin_x, grid.inverse_cell, grid.nx)
    y = axis_cell(position[1, i], grid.origin_y, grid.inverse_cell, grid.ny)
    z = axis_cell(position[2, i], grid.origin_z, grid.inverse_cell, grid.nz)
    cell[i] = x + grid.nx * (y + grid.ny * z)


def cell_index(position, phase, grid, cell):
    """See `melt.reference.grid.cell_index`."""
    _cell_index.launch(phase.shape[0], position, phase, grid, cell)


@cuda_kernel
def _clear(values, value):
    k = cuda.grid(1)
    if k < values.shape[0]:
        values[k] = value


@cuda_kernel
def _count(cell, cell_start):
    i = cuda.grid(1)
    if i < cell.shape[0]:
        cuda.atomic.add(cell_start, cell[i], 1)


@cuda_kernel
def _arrive(cell, cell_start, arrival):
    i = cuda.grid(1)
    if i < cell.shape[0]:
        place = cuda.atomic.add(cell_start, cell[i], -1) - 1
        arrival[place] = i


@cuda_kernel
def _rank(cell, arrival, cell_start, order):
    k = cuda.grid(1)
    if k >= cell_start[cell_start.shape[0] - 2]:
        return
    i = arrival[k]
    first, stop = cell_start[cell[i]], cell_start[cell[i] + 1]
    place = first
    for m in range(first, stop):
        if arrival[m] < i:
            place += 1
    order[place] = i


def cell_sort(cell, order, cell_start, arrival, chunk_sum):
    """See `melt.reference.grid.cell_sort`.

    Particles arrive in their cell in any order (integer atomics); then each one counts the
    smaller indices of its cell, which makes the order unique. Inactive particles, of which
    there may be very many in the last cell, are compacted by a prefix sum instead.
    """
    n, cells = cell.shape[0], cell_start.shape[0]
    _clear.launch(cells, cell_start, 0)
    _count.launch(n, cell, cell_start)
    inclusive_scan(cell_start, chunk_sum)  # the end of each cell, counted down to its start
    _arrive.launch(n, cell, cell_start, arrival)
    _rank.launch(n, cell, arrival, cell_start, order)
    place_equal(cell, cells - 2, cell_start, chunk_sum, order)


@cuda_kernel
def _reorder_scalar(order, source, target):
    k = cuda.grid(1)
    if k < order.shape[0]:
        target[k] = source[order[k]]


def reorder_scalar(order, source, target):
    """See `melt.reference.grid.reorder_scalar`."""
    _reorder_scalar.launch(order.shape[0], order, source, target)


@cuda_kernel
def _reorder_vector(order, source, target):
    k = cuda.grid(1)
    if k >= order.shape[0]:
        return
    j = order[k]
    for a in range(source.shape[0]):
        target[a, k] = source[a, j]


def reorder_vector(order, source, target):
    """See `melt.reference.grid.reorder_vector`."""
    _reorder_vector.launch(order.shape[0], order, source, target)


@cuda_kernel
def _site_particle(phase, site, site_particle):
    i = cuda.grid(1)
    if i < phase.shape[0] and phase[i] == SOLID and site[i] >= 0:
        site_particle[site[i]] = i


def site_particle(phase, site, site_particle):
    """See `melt.reference.grid.site_particle`."""
    _clear.launch(site_particle.shape[0], site_particle, -1)
    _site_particle.launch(phase.shape[0], phase, site, site_particle)
