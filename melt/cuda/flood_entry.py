"""CUDA twin of `melt.reference.flood_entry`."""

import math

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.physics.flood import support_of
from melt.physics.phases import LIQUID
from melt.physics.search import axis_cell


@cuda_kernel
def _entry_clearance(entry_position, position, phase, cell_start, grid, flood, entry_clearance):
    e = cuda.grid(1)
    if e >= entry_clearance.shape[0]:
        return
    real = type(flood.largest)
    rings = np.int32(flood.largest * grid.inverse_cell) + np.int32(1)
    x_e, y_e = entry_position[0, e], entry_position[1, e]
    c_x = axis_cell(x_e, grid.origin_x, grid.inverse_cell, grid.nx)
    c_y = axis_cell(y_e, grid.origin_y, grid.inverse_cell, grid.ny)
    first_x, last_x = max(c_x - rings, 0), min(c_x + rings, grid.nx - 1)
    nearest = flood.largest * flood.largest
    for row in range(max(c_y - rings, 0), min(c_y + rings + 1, grid.ny)):
        for j in range(cell_start[row * grid.nx + first_x], cell_start[row * grid.nx + last_x + 1]):
            x, y = real(position[0, j] - x_e), real(position[1, j] - y_e)
            r2 = x * x + y * y
            if phase[j] == LIQUID and r2 < nearest:
                nearest = r2
    entry_clearance[e] = min(math.sqrt(nearest), flood.largest)


def entry_clearance(entry_position, position, phase, cell_start, grid, flood, entry_clearance):
    """See `melt.reference.flood_entry.entry_clearance`."""
    _entry_clearance.launch(
        entry_clearance.shape[0], entry_position, position, phase, cell_start, grid, flood, entry_clearance
    )


@cuda_kernel
def _enter(
    entry_position, entry_velocity, entry_volume, flood, count, slot, density, first_id,
    phase, id, position, velocity, mass, rest_volume, support_radius, position_before, depth, brake,
):
    k = cuda.grid(1)
    if k >= count:
        return
    real = type(density)
    i = slot + k
    V = entry_volume[k]
    h = support_of(V, flood.reference_depth, flood)
    phase[i], id[i] = LIQUID, first_id + k
    for a in range(3):
        position[a, i], velocity[a, i] = entry_position[a, k], entry_velocity[a, k]
        if position_before.shape[1] > 0:  # none without a control force
            position_before[a, i] = entry_position[a, k]
    mass[i], rest_volume[i], support_radius[i] = density * V, V, h
    depth[i] = V * (flood.ratio / h) * (flood.ratio / h)
    if brake.shape[0] > 0:
        brake[i] = real(0)


def enter(
    entry_position, entry_velocity, entry_volume, flood, count, slot, density, first_id,
    phase, id, position, velocity, mass, rest_volume, support_radius, position_before, depth, brake,
):
    """See `melt.reference.flood_entry.enter`."""
    _enter.launch(
        count, entry_position, entry_velocity, entry_volume, flood, count, slot, density, first_id,
        phase, id, position, velocity, mass, rest_volume, support_radius, position_before, depth, brake,
    )
