"""CPU twin of `melt.reference.flood_bed`."""

from melt._compile import cpu_stage, prange
from melt.physics.phases import INACTIVE
from melt.physics.terrain import bed_sample, bed_second


@cpu_stage
def bed(position, phase, terrain, terrain_grid, bed, bed_slope):
    """See `melt.reference.flood_bed.bed`."""
    for i in prange(phase.shape[0]):
        b = s_x = s_y = terrain.dtype.type(0)
        if phase[i] != INACTIVE:
            b, s_x, s_y = bed_sample(position[0, i], position[1, i], terrain, terrain_grid)
        bed[i], bed_slope[0, i], bed_slope[1, i] = b, s_x, s_y


@cpu_stage
def bed_curvature(position, phase, terrain, terrain_grid, bed_curvature):
    """See `melt.reference.flood_bed.bed_curvature`."""
    for i in prange(phase.shape[0]):
        xx = yy = xy = terrain.dtype.type(0)
        if phase[i] != INACTIVE:
            xx, yy, xy = bed_second(position[0, i], position[1, i], terrain, terrain_grid)
        bed_curvature[0, i], bed_curvature[1, i], bed_curvature[2, i] = xx, yy, xy
