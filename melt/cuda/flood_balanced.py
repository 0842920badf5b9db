"""CUDA twin of `melt.reference.flood_balanced`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_forces import (
    balanced_factors,
    coincident,
    front_share,
    inner_share,
    may_be_front,
    separation,
    stands_in_void,
    surface_rise,
    wall_slope,
)
from melt.physics.phases import LIQUID


@cuda_kernel
def _balanced_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, bed, neighbour_count, neighbour_index,
    wall_count, wall_index, boundary_position, boundary_area, terrain, flood, terrain_grid, acceleration,
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
    ax = ay = sx = sy = wide(0)
    most = real(0)
    for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
        j = neighbour_index[i, k]
        x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
        h_j = support_radius[j]
        rise = surface_rise(bed[i], bed[j], d_i, depth[j])
        if math.sqrt(x * x + y * y) < max(h_i, h_j) and not abs(rise) <= most:
            most = abs(rise)
        if coincident(math.sqrt(x * x + y * y), h_i + h_j):
            x, y = separation(id[i], id[j], h_i + h_j)
        u, v = velocity[0, j] - u_i, velocity[1, j] - v_i
        f, g, F = balanced_factors(x, y, u, v, d_i, depth[j], h_i, h_j, rise, flood)
        ax += rest_volume[j] * (f * x + g * u)
        ay += rest_volume[j] * (f * y + g * v)
        sx += rest_volume[j] * (F * x)
        sy += rest_volume[j] * (F * y)
    walls = min(wall_count[i], wall_index.shape[1]) if wall_count.shape[0] > 0 else 0
    for k in range(walls):
        b = wall_index[i, k]
        x, y = real(x_i - boundary_position[0, b]), real(y_i - boundary_position[1, b])
        F = boundary_area[b] * wall_slope(math.sqrt(x * x + y * y), h_i, flood)
        sx += F * x
        sy += F * y
    s_x, s_y = real(sx), real(sy)
    share = inner_share(most, d_i, flood)
    if may_be_front(s_x, s_y, h_i):
        void = True
        for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
            j = neighbour_index[i, k]
            x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
            void = void and not stands_in_void(x, y, s_x, s_y, max(h_i, support_radius[j]))
        for k in range(walls):
            b = wall_index[i, k]
            x, y = real(x_i - boundary_position[0, b]), real(y_i - boundary_position[1, b])
            void = void and not stands_in_void(x, y, s_x, s_y, h_i)
        if void:
            share = front_share(x_i, y_i, s_x, s_y, bed[i] + d_i, d_i, h_i, terrain, terrain_grid)
    push = share * flood.gravity * d_i
    acceleration[0, i] = real(ax) - push * s_x
    acceleration[1, i] = real(ay) - push * s_y


def balanced_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, bed, neighbour_count, neighbour_index,
    wall_count, wall_index, boundary_position, boundary_area, terrain, flood, terrain_grid, acceleration,
):
    """See `melt.reference.flood_balanced.balanced_force`."""
    _balanced_force.launch(
        phase.shape[0], id, position, velocity, phase, rest_volume, depth, support_radius, bed, neighbour_count,
        neighbour_index, wall_count, wall_index, boundary_position, boundary_area, terrain, flood, terrain_grid,
        acceleration,
    )
