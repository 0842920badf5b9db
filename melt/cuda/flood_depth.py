"""CUDA twin of `melt.reference.flood_depth`. Pairs are read again in each iteration: a thread cannot keep them."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.flood import better_depth, inverse_support, scales2, support_limit, support_of, wall_share, weights2
from melt.physics.phases import AIRBORNE, LIQUID


@cuda_kernel
def _flood_depth(
    position, phase, rest_volume, bed, neighbour_count, neighbour_index, wall_count, wall_index, boundary_position,
    boundary_area, flood, support_radius, depth, support_factor, depth_state,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(flood.ratio)
    wide = position.dtype.type
    depth[i], support_factor[i], depth_state[i] = real(0), real(1), 0
    if phase[i] != LIQUID and phase[i] != AIRBORNE:
        return
    x_i, y_i, V, liquid = position[0, i], position[1, i], rest_volume[i], phase[i] == LIQUID
    scale, slope_scale = scales2(flood)
    # no walls for columns that fall, nor in scenes without any
    walls = wall_count[i] if liquid and wall_count.shape[0] > 0 else 0
    most = support_limit(support_radius[i], flood)
    low, high, inverse = real(1) / most, real(1) / flood.smallest, real(1) / support_radius[i]
    if liquid:
        inverse = min(inverse, high) if inverse > low else low
    per = real(1) / (flood.ratio * flood.ratio * V)
    d = inverse * inverse / per
    S, alpha, solved = wide(1), real(2), False
    for _ in range(max(flood.iterations, 1) if liquid else 1):
        norm = scale * inverse * inverse
        sum_w, sum_t = wide(V * weights2(real(0), flood)[0] if liquid else real(0)), wide(0)
        for k in range(neighbour_count[i]):
            j = neighbour_index[i, k]
            x, y = real(x_i - position[0, j]), real(y_i - position[1, j])
            w, t = weights2(math.sqrt(x * x + y * y) * inverse, flood)
            sum_w += rest_volume[j] * w
            sum_t += rest_volume[j] * t
        wall_w = wall_t = wet = wide(0)
        for k in range(walls):
            j = wall_index[i, k]
            x, y = real(x_i - boundary_position[0, j]), real(y_i - boundary_position[1, j])
            w, t = weights2(math.sqrt(x * x + y * y) * inverse, flood)
            carried = flood.reference_depth
            if flood.wall_mirror == 1:
                carried = max(real(wide(bed[i]) - boundary_position[2, j]) + d, real(0))  # E14
                wet += boundary_area[j] * w if carried > real(0) else real(0)
            wall_w += carried * boundary_area[j] * w
            wall_t += carried * boundary_area[j] * t
        gamma = norm * real(wet)
        share = wall_share(gamma, flood)
        S = wide(norm) * (sum_w + wide(share) * wall_w)
        if not liquid:
            depth[i] = real(S)
            return
        alpha = slope_scale * inverse * inverse * (real(sum_t) + share * real(wall_t))
        R = real(d - S)
        free = inverse > low and inverse < high and flood.iterations > 0
        solved = abs(R) <= flood.tolerance * d or flood.iterations == 0
        d = better_depth(d, R, norm * real(sum_w), alpha, share * gamma, free)
        before, inverse = inverse, inverse_support(d, per, low, high)
        if solved or (not free and inverse == before and gamma == real(0)):
            solved = True
            break
    h = min(max(support_of(V, d, flood), flood.smallest), most)
    omega = alpha / (real(2) * real(S))
    support_radius[i], depth[i] = h, d
    support_factor[i] = real(1) if h <= flood.smallest or h >= most or omega < real(0.2) else omega
    state = (1 if h >= flood.largest else 0) + (2 if h <= flood.smallest else 0) + (0 if solved else 4)
    depth_state[i] = state + (8 if neighbour_count[i] < 3 else 0)


def flood_depth(
    position, phase, rest_volume, bed, neighbour_count, neighbour_index, wall_count, wall_index, boundary_position,
    boundary_area, flood, support_radius, depth, support_factor, depth_state,
):
    """See `melt.reference.flood_depth.flood_depth`."""
    _flood_depth.launch(
        phase.shape[0], position, phase, rest_volume, bed, neighbour_count, neighbour_index, wall_count, wall_index,
        boundary_position, boundary_area, flood, support_radius, depth, support_factor, depth_state,
    )


@cuda_kernel
def _flood_surface(phase, bed, depth, position):
    i = cuda.grid(1)
    if i < phase.shape[0] and phase[i] == LIQUID:
        wide = position.dtype.type
        position[2, i] = wide(bed[i]) + wide(depth[i])


def flood_surface(phase, bed, depth, position):
    """See `melt.reference.flood_depth.flood_surface`."""
    _flood_surface.launch(phase.shape[0], phase, bed, depth, position)
