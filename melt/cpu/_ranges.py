"""Rows of sorted particles around a cell, along periodic axes too."""

from melt._compile import cpu_helper
from melt.physics.ranges import ROWS, row_cells


@cpu_helper
def rows_around(cell_start, grid, period, c_x, c_y, c_z, row):
    """Fill row (ROWS, 2) with the particle ranges of the distinct cells around a cell; return their number and total."""
    rows = total = 0
    for k in range(ROWS):
        first, stop = row_cells(k, c_x, c_y, c_z, grid, period)
        if cell_start[stop] > cell_start[first]:
            row[rows, 0], row[rows, 1] = cell_start[first], cell_start[stop]
            total += row[rows, 1] - row[rows, 0]
            rows += 1
    return rows, total
