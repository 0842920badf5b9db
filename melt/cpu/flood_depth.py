"""CPU twin of `melt.reference.flood_depth`.

Distances and volumes of a column's neighbours are gathered once into a buffer, padded with columns of no
volume to whole vectors; the iterations then run on contiguous numbers.
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.flood import better_depth, scale2, support_limit, support_of, wall_share, weights2
from melt.physics.phases import AIRBORNE, LIQUID

LANES = 32


@cpu_helper
def _gather(i, x_i, y_i, position, volume, count, index, r, V):
    """Fill r and V with the distances of the places listed for column i and their volumes (or areas)."""
    real = volume.dtype.type
    for k in range(np.uint64(count)):
        j = np.uint64(index[i, k])
        x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
        r[k] = math.sqrt(x * x + y * y)
        V[k] = volume[j]


@cpu_helper
def _pad(count, r, V):
    """Append columns of no volume up to a whole number of vectors; return how many there are then."""
    padded = (np.int64(count) + LANES - 1) // LANES * LANES
    for k in range(np.uint64(count), np.uint64(padded)):
        r[k] = V[k] = V.dtype.type(0)
    return padded


@cpu_helper
def _water(size, r, V, inverse, flood, none):
    """Return the sums of V w and V t over the buffer."""
    sum_w = sum_t = none
    for k in range(np.uint64(size)):
        w, t = weights2(r[k] * inverse, flood)
        sum_w += V[k] * w
        sum_t += V[k] * t
    return sum_w, sum_t


@cpu_helper
def _walls(size, r, area, above, d, inverse, flood, none):
    """Return the sums of d_b A w and d_b A t over walls, and that of A w over the wet ones. E14."""
    real = type(d)
    wall_w = wall_t = gamma = none
    for k in range(np.uint64(size)):
        w, t = weights2(r[k] * inverse, flood)
        carried = flood.reference_depth
        if flood.wall_mirror == 1:
            carried = max(above[k] + d, real(0))
            gamma += area[k] * w if carried > real(0) else real(0)
        wall_w += carried * area[k] * w
        wall_t += carried * area[k] * t
    return wall_w, wall_t, gamma


@cpu_helper
def _solve(V_i, h_old, size, r, V, walls, r_b, area, above, flood, none):
    """Return h, d, Omega and whether the iterations were enough. E9."""
    real = type(V_i)
    least, most, scale = flood.smallest, support_limit(h_old, flood), scale2(flood)
    h = max(h_old, least) if h_old < most else most
    d = V_i * (flood.ratio / h) * (flood.ratio / h)
    omega, solved = real(1), False
    for _ in range(max(flood.iterations, 1)):
        inverse = real(1) / h
        norm = scale * inverse * inverse
        sum_w, sum_t = _water(size, r, V, inverse, flood, none)
        wall_w, wall_t, gamma = _walls(walls, r_b, area, above, d, inverse, flood, none)
        share = wall_share(norm * real(gamma), flood)
        S = norm * (sum_w + share * wall_w)
        alpha = norm * (real(sum_t) + share * real(wall_t))
        R = real(d - S)
        solved = abs(R) <= flood.tolerance * d or flood.iterations == 0
        free = h > least and h < most and d > real(0) and flood.iterations > 0
        before = h
        d = better_depth(d, R, norm * real(sum_w), alpha, share * norm * real(gamma), free, flood)
        h = min(max(support_of(V_i, d, flood), least), most)
        omega = alpha / (real(2) * real(S))
        if solved or (not free and h == before and gamma == none):
            solved = True
            break
    return h, d, (real(1) if h <= least or h >= most or omega < real(0.2) else omega), solved


@cpu_helper
def _columns(
    first, stop, position, phase, rest_volume, bed, neighbour_count, neighbour_index, wall_count, wall_index,
    boundary_position, boundary_area, flood, support_radius, depth, support_factor, depth_state,
):
    real, wide = rest_volume.dtype.type, position.dtype.type
    room, beside = neighbour_index.shape[1] + 1 + LANES, wall_index.shape[1] + 1
    r, V = np.empty(room, rest_volume.dtype), np.empty(room, rest_volume.dtype)
    r_b, area, above = np.empty(beside, rest_volume.dtype), np.empty(beside, rest_volume.dtype), np.empty(beside, rest_volume.dtype)
    scale = scale2(flood)
    for i in range(first, stop):
        depth[i], support_factor[i], depth_state[i] = real(0), real(1), 0
        if phase[i] != LIQUID and phase[i] != AIRBORNE:
            continue
        count = np.int64(neighbour_count[i])
        x_i, y_i = position[0, i], position[1, i]
        _gather(i, x_i, y_i, position, rest_volume, count, neighbour_index, r, V)
        if phase[i] == AIRBORNE:
            inverse = real(1) / support_radius[i]
            sum_w, _ = _water(count, r, V, inverse, flood, wide(0))
            depth[i] = scale * inverse * inverse * real(sum_w)
            continue
        r[count], V[count] = real(0), rest_volume[i]
        size = _pad(count + 1, r, V)
        walls = np.int64(0)
        if wall_count.shape[0] > 0:
            walls = np.int64(wall_count[i])
            _gather(i, x_i, y_i, boundary_position, boundary_area, walls, wall_index, r_b, area)
            for k in range(np.uint64(walls)):
                above[k] = real(wide(bed[i]) - boundary_position[2, np.uint64(wall_index[i, k])])
        h, d, omega, solved = _solve(rest_volume[i], support_radius[i], size, r, V, walls, r_b, area, above, flood, wide(0))
        support_radius[i], depth[i], support_factor[i] = h, d, omega
        state = (1 if h >= flood.largest else 0) + (2 if h <= flood.smallest else 0) + (0 if solved else 4)
        depth_state[i] = state + (8 if count < 3 else 0)


@cpu_stage
def flood_depth(
    position, phase, rest_volume, bed, neighbour_count, neighbour_index, wall_count, wall_index, boundary_position,
    boundary_area, flood, support_radius, depth, support_factor, depth_state,
):
    """See `melt.reference.flood_depth.flood_depth`."""
    n = phase.shape[0]
    for chunk in prange(64):
        _columns(
            n * chunk // 64, n * (chunk + 1) // 64, position, phase, rest_volume, bed, neighbour_count, neighbour_index,
            wall_count, wall_index, boundary_position, boundary_area, flood, support_radius, depth, support_factor, depth_state,
        )


@cpu_stage
def flood_surface(phase, bed, depth, position):
    """See `melt.reference.flood_depth.flood_surface`."""
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] == LIQUID:
            position[2, i] = wide(bed[i]) + wide(depth[i])
