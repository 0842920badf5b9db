"""CUDA twin of `melt.reference.flood_force`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_forces import (
    along_wall,
    coincident,
    own_weight,
    pair_factors,
    separation,
    wall_slope,
    wall_stage,
)
from melt.physics.phases import LIQUID


@cuda_kernel
def _flood_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, support_factor, bed_slope, neighbour_count,
    neighbour_index, flood, acceleration,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(flood.gravity)
    wide = position.dtype.type
    if phase[i] != LIQUID:
        acceleration[0, i] = acceleration[1, i] = real(0)
        return
    x_i, y_i, u_i, v_i = position[0, i], position[1, i], velocity[0, i], velocity[1, i]
    h_i, d_i = support_radius[i], depth[i]
    c_i = own_weight(d_i, support_factor[i], flood)
    ax = ay = wide(0)
    for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
        j = neighbour_index[i, k]
        x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
        h_j = support_radius[j]
        if coincident(math.sqrt(x * x + y * y), h_i + h_j):
            x, y = separation(id[i], id[j], h_i + h_j)
        u, v = velocity[0, j] - u_i, velocity[1, j] - v_i
        c_j = own_weight(depth[j], support_factor[j], flood)
        f, g = pair_factors(x, y, u, v, d_i, depth[j], h_i, h_j, c_i, c_j, flood)
        ax += rest_volume[j] * (f * x + g * u)
        ay += rest_volume[j] * (f * y + g * v)
    acceleration[0, i] = real(ax) - flood.gravity * bed_slope[0, i]
    acceleration[1, i] = real(ay) - flood.gravity * bed_slope[1, i]


def flood_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, support_factor, bed_slope, neighbour_count,
    neighbour_index, flood, acceleration,
):
    """See `melt.reference.flood_force.flood_force`."""
    _flood_force.launch(
        phase.shape[0], id, position, velocity, phase, rest_volume, depth, support_radius, support_factor, bed_slope,
        neighbour_count, neighbour_index, flood, acceleration,
    )


@cuda_kernel
def _wall_force(
    position, phase, support_radius, depth, bed, support_factor, wall_count, wall_index, boundary_position,
    boundary_area, flood, acceleration,
):
    i = cuda.grid(1)
    if i >= wall_count.shape[0] or phase[i] != LIQUID:
        return
    real = type(flood.gravity)
    wide = position.dtype.type
    h_i, surface = support_radius[i], wide(bed[i] + depth[i])
    c_i = own_weight(depth[i], support_factor[i], flood)
    ax = ay = g_x = g_y = xx = xy = yy = wide(0)
    for k in range(min(wall_count[i], wall_index.shape[1])):
        b = wall_index[i, k]
        x, y = real(position[0, i] - boundary_position[0, b]), real(position[1, i] - boundary_position[1, b])
        carried = wall_stage(real(surface - boundary_position[2, b]), flood)
        F = boundary_area[b] * wall_slope(math.sqrt(x * x + y * y), h_i, flood)
        f = -c_i * carried * F
        ax += f * x
        ay += f * y
        F = F if carried > real(0) else real(0)
        g_x += F * x
        g_y += F * y
        xx -= F * x * x
        xy -= F * x * y
        yy -= F * y * y
    a_x, a_y = acceleration[0, i] + real(ax), acceleration[1, i] + real(ay)
    if flood.wall_mirror == 1:
        a_x, a_y = along_wall(a_x, a_y, real(g_x), real(g_y), real(xx), real(xy), real(yy), support_radius[i])
    acceleration[0, i], acceleration[1, i] = a_x, a_y


def wall_force(
    position, phase, support_radius, depth, bed, support_factor, wall_count, wall_index, boundary_position,
    boundary_area, flood, acceleration,
):
    """See `melt.reference.flood_force.wall_force`. Without walls the lists have no rows, and nothing is launched."""
    _wall_force.launch(
        wall_count.shape[0], position, phase, support_radius, depth, bed, support_factor, wall_count, wall_index,
        boundary_position, boundary_area, flood, acceleration,
    )
