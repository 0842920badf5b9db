"""The distinct cells around a cell of the neighbour grid, as rows that are contiguous along x; periodic axes wrap.

A periodic axis is spanned by whole cells: its length is their number times their edge.
"""

from melt._compile import scalar
from melt.physics.search import axis_cell

#: Rows that `row_cells` counts: three by three lines of cells, in two pieces where x wraps.
ROWS = 18


@scalar
def reach(cell, count, length):
    """Return (first, number) of the cells within one of a cell along an axis of ``count``; first = -1 wraps."""
    if length > 0:
        return (0, int(count)) if count <= 3 else (cell - 1, 3)
    first = max(cell - 1, 0)
    return first, min(cell + 2, int(count)) - first


@scalar
def row_cells(k, c_x, c_y, c_z, grid, period):
    """Return (first, stop) of the cells in row k of `ROWS` around cell (c_x, c_y, c_z); equal where there is none."""
    first, number = reach(c_z, grid.nz, period.length_z)
    z = first + k // 6
    if k // 6 >= number:
        return 0, 0
    z = z + int(grid.nz) if z < 0 else (z - int(grid.nz) if z >= grid.nz else z)
    first, number = reach(c_y, grid.ny, period.length_y)
    y = first + (k // 2) % 3
    if (k // 2) % 3 >= number:
        return 0, 0
    y = y + int(grid.ny) if y < 0 else (y - int(grid.ny) if y >= grid.ny else y)
    line, nx = int(grid.nx) * (y + int(grid.ny) * z), int(grid.nx)
    first, number = reach(c_x, grid.nx, period.length_x)
    if k % 2 == 0:
        return line + max(first, 0), line + min(first + number, nx)
    if first < 0:
        return line + nx - 1, line + nx
    return line, line + max(first + number - nx, 0)


@scalar
def cell_at(x, y, z, grid):
    """Return the cell (c_x, c_y, c_z) of a position, as `melt.reference.grid.cell_index` sorts it."""
    c_x = axis_cell(x, grid.origin_x, grid.inverse_cell, grid.nx)
    c_y = axis_cell(y, grid.origin_y, grid.inverse_cell, grid.ny)
    return c_x, c_y, axis_cell(z, grid.origin_z, grid.inverse_cell, grid.nz)
