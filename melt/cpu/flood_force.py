"""CPU twin of `melt.reference.flood_force`.

The loop over pairs fetches 8 numbers of a partner, and that is half of its cost. Measured at 59,536 columns with 25.7
listed, float32, 2 threads, in a busy machine: 1.5 ms for the fetching alone, 3.1 ms in all; without vectors 11 ms. A
call for each column instead of each piece costs 0.25 ms, the choice of form 0.3, the test for columns at one place 0.1.
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._flood_pairs import LANES
from melt.physics.flood_forces import (
    along_wall,
    coincident,
    own_weight,
    pair_factors,
    pressure_divisor,
    pressure_pair,
    pressure_weight,
    separation,
    slope_scale,
    slope_shape,
    stabilisation,
    wall_slope,
    wall_stage,
)
from melt.physics.phases import LIQUID


@cpu_helper
def _coincident(i, row, count, id, position, velocity, rest_volume, depth, support_radius, support_factor, flood):
    """Return the acceleration of i by the columns that stand where i does."""
    real = type(flood.gravity)
    ax = ay = position.dtype.type(0)
    c_i = own_weight(depth[i], support_factor[i], flood)
    for k in range(count):
        j = row[k]
        x, y = real(position[0, i] - position[0, j]), real(position[1, i] - position[1, j])
        h_i, h_j = support_radius[i], support_radius[j]
        if coincident(math.sqrt(x * x + y * y), h_i + h_j):
            x, y = separation(id[i], id[j], h_i + h_j)
            u, v = velocity[0, j] - velocity[0, i], velocity[1, j] - velocity[1, i]
            c_j = own_weight(depth[j], support_factor[j], flood)
            f, g = pair_factors(x, y, u, v, depth[i], depth[j], h_i, h_j, c_i, c_j, flood)
            ax += rest_volume[j] * (f * x + g * u)
            ay += rest_volume[j] * (f * y + g * v)
    return ax, ay


@cpu_helper
def _columns(
    first, last, id, position, velocity, phase, rest_volume, depth, support_radius, support_factor, bed_slope,
    neighbour_count, neighbour_index, flood, acceleration,
):
    """Write the accelerations of the columns from first to last."""
    real, one = type(flood.gravity), type(flood.gravity)(1)
    row = np.empty(neighbour_index.shape[1] + LANES, np.int32)
    for n in range(first, last):
        i = np.uint64(n)
        if phase[i] != LIQUID:
            acceleration[0, i] = acceleration[1, i] = real(0)
            continue
        count = np.uint64(min(neighbour_count[i], neighbour_index.shape[1]))
        stop = (count + np.uint64(LANES - 1)) // np.uint64(LANES) * np.uint64(LANES)
        for k in range(count):
            row[k] = neighbour_index[i, k]
        for k in range(count, stop):
            row[k] = n
        x_i, y_i, u_i, v_i = position[0, i], position[1, i], velocity[0, i], velocity[1, i]
        h_i, d_i = support_radius[i], depth[i]
        wave_i, inverse_i = math.sqrt(flood.gravity * d_i), one / h_i
        scale_i, c_i = slope_scale(inverse_i, flood), own_weight(d_i, support_factor[i], flood)
        ax = ay = position.dtype.type(0)
        same = real(0)  # columns that stand where i does, and the padding
        for k in range(stop):
            j = np.uint64(row[k])
            x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
            u, v = velocity[0, j] - u_i, velocity[1, j] - v_i
            h_j, d_j, V_j = support_radius[j], depth[j], rest_volume[j]
            divisor = pressure_divisor(d_j, support_factor[j], flood)
            r = math.sqrt(x * x + y * y)
            close = coincident(r, h_i + h_j)
            same += real(close)  # a sum of selected ones is not vectorised
            safe = max(r, real(1e-12))
            t = one / (h_j * safe * divisor)  # one division for three
            inverse_j = t * safe * divisor
            slope_i = scale_i * slope_shape(r * inverse_i, flood)
            slope_j = slope_scale(inverse_j, flood) * slope_shape(r * inverse_j, flood)
            mean = real(0.5) * (slope_i + slope_j)
            push, g = stabilisation(r, -(u * x + v * y), mean, h_i + h_j, d_i, d_j, wave_i, flood)
            push += pressure_pair(slope_i, slope_j, c_i, pressure_weight(d_j, t * safe * h_j, flood), flood)
            V_j = real(0) if close else V_j
            f = -push * (t * h_j * divisor)
            ax += V_j * (f * x + g * u)
            ay += V_j * (f * y + g * v)
        if same > real(stop - count):
            bx, by = _coincident(
                n, row, np.int64(count), id, position, velocity, rest_volume, depth, support_radius, support_factor, flood,
            )
            ax += bx
            ay += by
        acceleration[0, i] = real(ax) - flood.gravity * bed_slope[0, i]
        acceleration[1, i] = real(ay) - flood.gravity * bed_slope[1, i]


@cpu_stage
def flood_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, support_factor, bed_slope, neighbour_count,
    neighbour_index, flood, acceleration,
):
    """See `melt.reference.flood_force.flood_force`."""
    n = phase.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: inactive slots stand together
        _columns(
            n * piece // 64, n * (piece + 1) // 64, id, position, velocity, phase, rest_volume, depth, support_radius,
            support_factor, bed_slope, neighbour_count, neighbour_index, flood, acceleration,
        )


@cpu_stage
def wall_force(
    position, phase, support_radius, depth, bed, support_factor, wall_count, wall_index, boundary_position,
    boundary_area, flood, acceleration,
):
    """See `melt.reference.flood_force.wall_force`."""
    real = type(flood.gravity)
    wide = position.dtype.type
    for i in prange(wall_count.shape[0]):  # 0 without walls
        if phase[i] != LIQUID:
            continue
        h_i, surface = support_radius[i], wide(bed[i] + depth[i])
        c_i = own_weight(depth[i], support_factor[i], flood)
        ax = ay = g_x = g_y = xx = xy = yy = wide(0)
        for k in range(np.uint64(min(np.int64(wall_count[i]), wall_index.shape[1]))):
            b = np.uint64(wall_index[i, k])
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
