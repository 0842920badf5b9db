"""CUDA twin of `melt.reference.flood_bed`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import INACTIVE
from melt.physics.terrain import bed_sample, bed_second


@cuda_kernel
def _bed(position, phase, terrain, terrain_grid, bed, bed_slope):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    b = s_x = s_y = terrain.dtype.type(0)
    if phase[i] != INACTIVE:
        b, s_x, s_y = bed_sample(position[0, i], position[1, i], terrain, terrain_grid)
    bed[i], bed_slope[0, i], bed_slope[1, i] = b, s_x, s_y


def bed(position, phase, terrain, terrain_grid, bed, bed_slope):
    """See `melt.reference.flood_bed.bed`."""
    _bed.launch(phase.shape[0], position, phase, terrain, terrain_grid, bed, bed_slope)


@cuda_kernel
def _bed_curvature(position, phase, terrain, terrain_grid, bed_curvature):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    xx = yy = xy = terrain.dtype.type(0)
    if phase[i] != INACTIVE:
        xx, yy, xy = bed_second(position[0, i], position[1, i], terrain, terrain_grid)
    bed_curvature[0, i], bed_curvature[1, i], bed_curvature[2, i] = xx, yy, xy


def bed_curvature(position, phase, terrain, terrain_grid, bed_curvature):
    """See `melt.reference.flood_bed.bed_curvature`."""
    _bed_curvature.launch(phase.shape[0], position, phase, terrain, terrain_grid, bed_curvature)
