"""CPU twin of `melt.reference.flood_balanced`."""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._flood_pairs import LANES, padded_row
from melt.physics.flood_forces import (
    balanced_factors,
    coincident,
    front_share,
    inner_share,
    may_be_front,
    separation,
    slope_scale,
    slope_shape,
    stabilisation,
    stands_in_void,
    surface_rise,
    wall_slope,
)
from melt.physics.phases import LIQUID


@cpu_helper
def _pairs(i, row, stop, position, velocity, rest_volume, depth, support_radius, bed, flood):
    """Return acceleration and S of i by the columns of a padded row, and how many stand where i does."""
    real = type(flood.gravity)
    wide = position.dtype.type
    x_i, y_i, u_i, v_i = position[0, i], position[1, i], velocity[0, i], velocity[1, i]
    h_i, d_i, b_i, one = support_radius[i], depth[i], bed[i], real(1)
    wave_i, inverse_i = math.sqrt(flood.gravity * d_i), one / h_i
    scale_i = slope_scale(inverse_i, flood)
    ax = ay = sx = sy = wide(0)
    same = real(0)
    for k in range(np.uint64(stop) // np.uint64(LANES) * np.uint64(LANES)):
        j = np.uint64(row[k])
        x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
        u, v = velocity[0, j] - u_i, velocity[1, j] - v_i
        h_j, d_j, V_j = support_radius[j], depth[j], rest_volume[j]
        r = math.sqrt(x * x + y * y)
        close = coincident(r, h_i + h_j)
        same += real(close)
        safe = max(r, real(1e-12))
        t = one / (h_j * safe * d_j)  # one division for three
        inverse_j = t * safe * d_j
        slope_i = scale_i * slope_shape(r * inverse_i, flood)
        slope_j = slope_scale(inverse_j, flood) * slope_shape(r * inverse_j, flood)
        mean = real(0.5) * (slope_i + slope_j)
        push, g = stabilisation(r, -(u * x + v * y), mean, h_i + h_j, d_i, d_j, wave_i, flood)
        V_j = real(0) if close else V_j
        over = V_j * (t * h_j * d_j)
        F = over * mean * (t * safe * h_j)  # A_j dW/dr / r
        f = -push * over - flood.gravity * surface_rise(b_i, bed[j], d_i, d_j) * F
        ax += f * x + V_j * (g * u)
        ay += f * y + V_j * (g * v)
        sx += F * x
        sy += F * y
    return ax, ay, sx, sy, same


@cpu_helper
def _coincident(i, row, count, id, position, velocity, rest_volume, depth, support_radius, bed, flood):
    """Return acceleration and S of i by the columns that stand where i does."""
    real = type(flood.gravity)
    ax = ay = sx = sy = position.dtype.type(0)
    for k in range(count):
        j = row[k]
        x, y = real(position[0, i] - position[0, j]), real(position[1, i] - position[1, j])
        h_i, h_j = support_radius[i], support_radius[j]
        if coincident(math.sqrt(x * x + y * y), h_i + h_j):
            x, y = separation(id[i], id[j], h_i + h_j)
            u, v = velocity[0, j] - velocity[0, i], velocity[1, j] - velocity[1, i]
            rise = surface_rise(bed[i], bed[j], depth[i], depth[j])
            f, g, F = balanced_factors(x, y, u, v, depth[i], depth[j], h_i, h_j, rise, flood)
            ax += rest_volume[j] * (f * x + g * u)
            ay += rest_volume[j] * (f * y + g * v)
            sx += rest_volume[j] * (F * x)
            sy += rest_volume[j] * (F * y)
    return ax, ay, sx, sy


@cpu_helper
def _largest_rise(i, row, count, position, depth, support_radius, bed):
    """Return the largest difference of the surface to that of a column within either support."""
    real = depth.dtype.type
    most = real(0)
    for k in range(np.uint64(count)):
        j = np.uint64(row[k])
        x, y = real(position[0, i] - position[0, j]), real(position[1, i] - position[1, j])
        h = max(support_radius[i], support_radius[j])
        rise = abs(surface_rise(bed[i], bed[j], depth[i], depth[j]))
        most = rise if math.sqrt(x * x + y * y) < h and not rise <= most else most
    return most


@cpu_helper
def _closure(i, position, support_radius, wall_count, wall_index, boundary_position, boundary_area, flood):
    """Return what walls add to S of i."""
    real = type(flood.gravity)
    sx = sy = position.dtype.type(0)
    if wall_count.shape[0] == 0:
        return sx, sy
    for k in range(np.uint64(min(np.int64(wall_count[i]), wall_index.shape[1]))):
        b = np.uint64(wall_index[i, k])
        x, y = real(position[0, i] - boundary_position[0, b]), real(position[1, i] - boundary_position[1, b])
        F = boundary_area[b] * wall_slope(math.sqrt(x * x + y * y), support_radius[i], flood)
        sx += F * x
        sy += F * y
    return sx, sy


@cpu_helper
def _at_void(i, row, count, s_x, s_y, position, support_radius, wall_count, wall_index, boundary_position):
    """Return whether i stands beside a void: S does not close, and no column or wall stands where it points away from."""
    real = support_radius.dtype.type
    h_i = support_radius[i]
    if not may_be_front(s_x, s_y, h_i):
        return False
    for k in range(count):
        j = row[k]
        x, y = real(position[0, i] - position[0, j]), real(position[1, i] - position[1, j])
        if stands_in_void(x, y, s_x, s_y, max(h_i, support_radius[j])):
            return False
    walls = min(np.int64(wall_count[i]), wall_index.shape[1]) if wall_count.shape[0] > 0 else 0
    for k in range(walls):
        b = wall_index[i, k]
        x, y = real(position[0, i] - boundary_position[0, b]), real(position[1, i] - boundary_position[1, b])
        if stands_in_void(x, y, s_x, s_y, h_i):
            return False
    return True


@cpu_helper
def _column(
    i, count, stop, row, id, position, velocity, rest_volume, depth, support_radius, bed, wall_count, wall_index,
    boundary_position, boundary_area, terrain, flood, terrain_grid,
):
    """Return the acceleration of i."""
    real = type(flood.gravity)
    ax, ay, sx, sy, same = _pairs(i, row, stop, position, velocity, rest_volume, depth, support_radius, bed, flood)
    if same > real(stop - count):
        bx, by, tx, ty = _coincident(
            i, row, count, id, position, velocity, rest_volume, depth, support_radius, bed, flood,
        )
        ax, ay, sx, sy = ax + bx, ay + by, sx + tx, sy + ty
    tx, ty = _closure(i, position, support_radius, wall_count, wall_index, boundary_position, boundary_area, flood)
    s_x, s_y, d, h = real(sx + tx), real(sy + ty), depth[i], support_radius[i]
    if _at_void(i, row, count, s_x, s_y, position, support_radius, wall_count, wall_index, boundary_position):
        share = front_share(position[0, i], position[1, i], s_x, s_y, bed[i] + d, d, h, terrain, terrain_grid)
    else:
        share = inner_share(_largest_rise(i, row, count, position, depth, support_radius, bed), d, flood)
    push = share * flood.gravity * d
    return real(ax) - push * s_x, real(ay) - push * s_y


@cpu_stage
def balanced_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, bed, neighbour_count, neighbour_index,
    wall_count, wall_index, boundary_position, boundary_area, terrain, flood, terrain_grid, acceleration,
):
    """See `melt.reference.flood_balanced.balanced_force`."""
    real = type(flood.gravity)
    n = phase.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: inactive slots stand together
        row = np.empty(neighbour_index.shape[1] + LANES, np.int32)
        for i in range(n * piece // 64, n * (piece + 1) // 64):
            if phase[i] != LIQUID:
                acceleration[0, i] = acceleration[1, i] = real(0)
                continue
            count, stop = padded_row(i, neighbour_count, neighbour_index, row)
            acceleration[0, i], acceleration[1, i] = _column(
                i, count, stop, row, id, position, velocity, rest_volume, depth, support_radius, bed, wall_count,
                wall_index, boundary_position, boundary_area, terrain, flood, terrain_grid,
            )
