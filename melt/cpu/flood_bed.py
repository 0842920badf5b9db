"""CPU twin of `melt.reference.flood_bed`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.params import SAMPLER_BSPLINE
from melt.physics.phases import INACTIVE
from melt.physics.terrain import bed_sample, bed_second, inside, nearest_node, place_of, spline


@cpu_stage
def bed(position, phase, terrain, terrain_grid, bed, bed_slope):
    """See `melt.reference.flood_bed.bed`.

    The B-spline is written out: nodes are read here, where a call that takes the array costs half as much again.
    """
    one, nx, ny = np.int32(1), np.int32(terrain_grid.nx), np.int32(terrain_grid.ny)
    for n in prange(phase.shape[0]):
        b = x = y = terrain.dtype.type(0)
        if phase[n] != INACTIVE and terrain_grid.sampler == SAMPLER_BSPLINE:
            t_x, t_y = place_of(position[0, n], position[1, n], terrain_grid)
            i, j, u, v = nearest_node(t_x, t_y, terrain_grid.inverse_dx)
            w, h, e = inside(i - one, nx), inside(i, nx), inside(i + one, nx)
            r, s, t = inside(j - one, ny) * nx, inside(j, ny) * nx, inside(j + one, ny) * nx
            b0, x0, _ = spline(terrain[np.uint64(r + w)], terrain[np.uint64(r + h)], terrain[np.uint64(r + e)], u)
            b1, x1, _ = spline(terrain[np.uint64(s + w)], terrain[np.uint64(s + h)], terrain[np.uint64(s + e)], u)
            b2, x2, _ = spline(terrain[np.uint64(t + w)], terrain[np.uint64(t + h)], terrain[np.uint64(t + e)], u)
            b, y, _ = spline(b0, b1, b2, v)
            x, _, _ = spline(x0, x1, x2, v)
            x, y = x * terrain_grid.inverse_dx, y * terrain_grid.inverse_dy
        elif phase[n] != INACTIVE:
            b, x, y = bed_sample(position[0, n], position[1, n], terrain, terrain_grid)
        bed[n], bed_slope[0, n], bed_slope[1, n] = b, x, y


@cpu_stage
def bed_curvature(position, phase, terrain, terrain_grid, bed_curvature):
    """See `melt.reference.flood_bed.bed_curvature`."""
    for i in prange(phase.shape[0]):
        xx = yy = xy = terrain.dtype.type(0)
        if phase[i] != INACTIVE:
            xx, yy, xy = bed_second(position[0, i], position[1, i], terrain, terrain_grid)
        bed_curvature[0, i], bed_curvature[1, i], bed_curvature[2, i] = xx, yy, xy
