"""CPU twin of `melt.reference.flood_depth`.

Columns are solved in batches: distances and volumes of their neighbours are gathered once, padded with columns
of no volume to whole vectors, and each iteration then sums for the whole batch before it corrects the whole
batch. One column after the other waits for its own divisions and square roots between the sums (measured: 38 ns
for each iteration of a column instead of 20).
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.flood import better_depth, inverse_support, scales2, support_limit, support_of, wall_share, weights2
from melt.physics.phases import AIRBORNE, LIQUID

BATCH, LANES = 64, 32
# rows of the table of a batch: depth, 1/h and its least, 1/(ratio^2 V), residual, sums, of water alone, alpha, gamma
D, INVERSE, LOW, PER, R, S, WATER, ALPHA, GAMMA = range(9)
ROWS = 9


@cpu_helper
def _gather(members, number, position, rest_volume, neighbour_count, neighbour_index, near, first):
    """Fill near with distances and volumes of each member's neighbours and of itself; member b's are first[b] .. first[b+1]."""
    real, slot = rest_volume.dtype.type, np.uint64(0)
    for b in range(np.uint64(number)):
        i = np.uint64(members[b])
        count, x_i, y_i = np.uint64(neighbour_count[i]), position[0, i], position[1, i]
        for k in range(count):
            j = np.uint64(neighbour_index[i, k])
            x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
            near[0, slot + k], near[1, slot + k] = x * x + y * y, rest_volume[j]
        padded = (count + np.uint64(LANES)) // np.uint64(LANES) * np.uint64(LANES)
        for k in range(slot + count, slot + padded):
            near[0, k] = near[1, k] = real(0)
        near[1, slot + count] = rest_volume[i]
        first[b], slot = slot, slot + padded
    first[number] = slot
    for k in range(slot):  # in whole vectors, which the loop above cannot be
        near[0, k] = math.sqrt(near[0, k])


@cpu_helper
def _gather_walls(members, number, position, bed, wall_count, wall_index, boundary_position, boundary_area, beside, walls):
    """Fill beside with distances and areas of walls and the member's bed above theirs, and walls with their number."""
    real, wide = bed.dtype.type, position.dtype.type
    for b in range(np.uint64(number)):
        i = np.uint64(members[b])
        walls[b] = wall_count[i]
        for k in range(np.uint64(wall_count[i])):
            j = np.uint64(wall_index[i, k])
            x, y = real(position[0, i] - boundary_position[0, j]), real(position[1, i] - boundary_position[1, j])
            beside[0, b, k], beside[1, b, k] = math.sqrt(x * x + y * y), boundary_area[j]
            beside[2, b, k] = real(wide(bed[i]) - boundary_position[2, j])


@cpu_helper
def _start(members, number, rest_volume, support_radius, flood, table, done):
    """Fill the table with the depths that the supports of before belong to."""
    real = rest_volume.dtype.type
    high = real(1) / flood.smallest
    for b in range(np.uint64(number)):
        i = np.uint64(members[b])
        low, inverse = real(1) / support_limit(support_radius[i], flood), real(1) / support_radius[i]
        inverse = min(inverse, high) if inverse > low else low
        per = real(1) / (flood.ratio * flood.ratio * rest_volume[i])
        table[D, b], table[INVERSE, b], table[LOW, b], table[PER, b] = inverse * inverse / per, inverse, low, per
        done[b] = 0


@cpu_helper
def _walls(size, beside, d, inverse, flood, none):
    """Return the sums of d_b A w and d_b A t over walls, and that of A w over the wet ones. E14."""
    real = type(d)
    wall_w = wall_t = wet = none
    for k in range(np.uint64(size)):
        w, t = weights2(beside[0, k] * inverse, flood)
        carried = flood.reference_depth
        if flood.wall_mirror == 1:
            carried = max(beside[2, k] + d, real(0))
            wet += beside[1, k] * w if carried > real(0) else real(0)
        wall_w += carried * beside[1, k] * w
        wall_t += carried * beside[1, k] * t
    return wall_w, wall_t, wet


@cpu_helper
def _evaluate(number, near, first, beside, walls, flood, none, table, done):
    """Fill in residual and sums of the members that are not done. E9."""
    real = near.dtype.type
    scale, slope_scale = scales2(flood)
    for b in range(np.uint64(number)):
        if done[b] == 1:
            continue
        inverse, d = table[INVERSE, b], table[D, b]
        sum_w = sum_t = wall_w = wall_t = wet = none
        for k in range(np.uint64(first[b]), np.uint64(first[b + np.uint64(1)])):
            w, t = weights2(near[0, k] * inverse, flood)
            sum_w += near[1, k] * w
            sum_t += near[1, k] * t
        if walls[b] > 0:
            wall_w, wall_t, wet = _walls(walls[b], beside[:, b], d, inverse, flood, none)
        norm = scale * inverse * inverse
        gamma = norm * real(wet)
        share = wall_share(gamma, flood)
        total = norm * (sum_w + share * wall_w)
        table[R, b], table[S, b], table[WATER, b] = d - total, total, norm * real(sum_w)
        table[ALPHA, b] = slope_scale * inverse * inverse * (real(sum_t) + share * real(wall_t))
        table[GAMMA, b] = share * gamma


@cpu_helper
def _correct(number, flood, table, done):
    """Take a Newton step for the members that are not done; return how many are not yet."""
    real = table.dtype.type
    high, left = real(1) / flood.smallest, 0
    for b in range(np.uint64(number)):
        if done[b] == 1:
            continue
        d, before, low = table[D, b], table[INVERSE, b], table[LOW, b]
        solved = abs(table[R, b]) <= flood.tolerance * d or flood.iterations == 0
        free = before > low and before < high and flood.iterations > 0
        d = better_depth(d, table[R, b], table[WATER, b], table[ALPHA, b], table[GAMMA, b], free)
        inverse = inverse_support(d, table[PER, b], low, high)
        table[D, b], table[INVERSE, b] = d, inverse
        done[b] = solved or (not free and inverse == before and table[GAMMA, b] == real(0))
        left += 1 - done[b]
    return left


@cpu_helper
def _finish(members, number, rest_volume, neighbour_count, flood, table, done, support_radius, depth, support_factor, depth_state):
    """Write what the members of a batch have come to."""
    real = rest_volume.dtype.type
    for b in range(np.uint64(number)):
        i = np.uint64(members[b])
        most, d, omega = support_limit(support_radius[i], flood), table[D, b], table[ALPHA, b] / (real(2) * table[S, b])
        h = min(max(support_of(rest_volume[i], d, flood), flood.smallest), most)
        support_radius[i], depth[i] = h, d
        support_factor[i] = real(1) if h <= flood.smallest or h >= most or omega < real(0.2) else omega
        state = (1 if h >= flood.largest else 0) + (2 if h <= flood.smallest else 0) + (0 if done[b] == 1 else 4)
        depth_state[i] = state + (8 if neighbour_count[i] < 3 else 0)


@cpu_helper
def _water_under(i, position, rest_volume, neighbour_count, neighbour_index, h, flood):
    """Return the depth of the water under a falling column."""
    real, wide = rest_volume.dtype.type, position.dtype.type
    inverse, total = real(1) / h, wide(0)
    for k in range(np.uint64(neighbour_count[i])):
        j = np.uint64(neighbour_index[i, k])
        x, y = real(position[0, i] - position[0, j]), real(position[1, i] - position[1, j])
        total += rest_volume[j] * weights2(math.sqrt(x * x + y * y) * inverse, flood)[0]
    return scales2(flood)[0] * inverse * inverse * real(total)


@cpu_helper
def _columns(
    first, stop, position, phase, rest_volume, bed, neighbour_count, neighbour_index, wall_count, wall_index,
    boundary_position, boundary_area, flood, support_radius, depth, support_factor, depth_state,
):
    real, none = rest_volume.dtype.type, position.dtype.type(0)
    near = np.empty((2, BATCH * (neighbour_index.shape[1] + 1 + LANES)), rest_volume.dtype)
    beside = np.empty((3, BATCH, wall_index.shape[1] + 1), rest_volume.dtype)
    table = np.ones((ROWS, BATCH), rest_volume.dtype)
    members, walls, done = np.zeros(BATCH, np.int64), np.zeros(BATCH, np.int64), np.zeros(BATCH, np.int64)
    begin = np.zeros(BATCH + 1, np.int64)
    number = 0
    for i in range(np.uint64(first), np.uint64(stop)):
        if phase[i] == LIQUID:
            members[number] = i
            number += 1
        else:
            depth[i], support_factor[i], depth_state[i] = real(0), real(1), 0
            if phase[i] == AIRBORNE:
                depth[i] = _water_under(i, position, rest_volume, neighbour_count, neighbour_index, support_radius[i], flood)
        if number == BATCH or (number > 0 and i + np.uint64(1) == np.uint64(stop)):
            _gather(members, number, position, rest_volume, neighbour_count, neighbour_index, near, begin)
            if wall_count.shape[0] > 0:
                _gather_walls(members, number, position, bed, wall_count, wall_index, boundary_position, boundary_area, beside, walls)
            _start(members, number, rest_volume, support_radius, flood, table, done)
            for _ in range(max(flood.iterations, 1)):
                _evaluate(number, near, begin, beside, walls, flood, none, table, done)
                if _correct(number, flood, table, done) == 0:
                    break
            _finish(
                members, number, rest_volume, neighbour_count, flood, table, done, support_radius, depth, support_factor, depth_state,
            )
            number = 0


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
