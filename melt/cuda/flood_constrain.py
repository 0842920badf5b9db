"""CUDA twin of `melt.reference.flood_constrain`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_forces import bed_push
from melt.physics.phases import LIQUID


@cuda_kernel
def _constrain_to_bed(phase, velocity, bed_slope, bed_curvature, flood, acceleration):
    i = cuda.grid(1)
    if i >= phase.shape[0] or phase[i] != LIQUID:
        return
    g = flood.gravity
    u, v, s_x, s_y = velocity[0, i], velocity[1, i], bed_slope[0, i], bed_slope[1, i]
    t_x, t_y = -acceleration[0, i] - g * s_x, -acceleration[1, i] - g * s_y
    xx, yy, xy = bed_curvature[0, i], bed_curvature[1, i], bed_curvature[2, i]
    push = bed_push(u, v, s_x, s_y, t_x, t_y, xx, yy, xy, flood)
    acceleration[0, i] = -push * s_x - t_x
    acceleration[1, i] = -push * s_y - t_y


def constrain_to_bed(phase, velocity, bed_slope, bed_curvature, flood, acceleration):
    """See `melt.reference.flood_constrain.constrain_to_bed`."""
    _constrain_to_bed.launch(phase.shape[0], phase, velocity, bed_slope, bed_curvature, flood, acceleration)
