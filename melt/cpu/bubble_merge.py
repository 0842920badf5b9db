"""CPU twin of `melt.reference.bubble_merge`."""

import numpy as np

from melt._compile import cpu_helper, cpu_serial, cpu_stage, prange
from melt.physics.bubble_life import coarse_cell, coarse_count, current_volume, merged_sums
from melt.physics.bubbles import radius_of
from melt.physics.phases import BUBBLE, INACTIVE
from melt.physics.search import squared_distance


@cpu_stage
def bubble_cell(position, phase, grid, coarse, bubble_cell):
    """See `melt.reference.bubble_merge.bubble_cell`."""
    for i in prange(phase.shape[0]):
        cell = int(grid.nx) * int(grid.ny) * int(grid.nz)
        if phase[i] == BUBBLE:
            cell = coarse_cell(position[0, i], position[1, i], position[2, i], grid, coarse)
        bubble_cell[i] = cell


@cpu_helper
def _root(parent, s):
    while parent[s] != s:
        parent[s] = parent[parent[s]]
        s = parent[s]
    return s


@cpu_helper
def _unite(parent, place, i, j):
    """Join two trees; the root that comes first in the list stays."""
    a, b = _root(parent, i), _root(parent, j)
    if place[a] < place[b]:
        parent[b] = a
    else:
        parent[a] = b


@cpu_serial
def merge_label(
    position, bubble_radius, age, bubble_index, bubble_count, bubble_cell, bubble_order, bubble_start,
    grid, bubbles, coarse, merge_root, merge_size,
):
    """See `melt.reference.bubble_merge.merge_label`: union-find; merge_size holds places in the list meanwhile."""
    real = type(bubbles.spacing)
    nx, ny, nz = coarse_count(grid.nx, coarse), coarse_count(grid.ny, coarse), coarse_count(grid.nz, coarse)
    merge_root[:] = -1
    merge_size[:] = 0
    for a in range(bubble_count[0]):
        merge_root[bubble_index[a]] = bubble_index[a]
        merge_size[bubble_index[a]] = a
    for a in range(bubble_count[0]):
        i = bubble_index[a]
        if not age[i] >= bubbles.merge_age:
            continue
        c = bubble_cell[i]
        cx, cy, cz = c % nx, c // nx % ny, c // (nx * ny)
        for z in range(max(cz - 1, 0), min(cz + 2, nz)):
            for y in range(max(cy - 1, 0), min(cy + 2, ny)):
                row = nx * (y + ny * z)
                for k in range(bubble_start[row + max(cx - 1, 0)], bubble_start[row + min(cx + 2, nx)]):
                    j = bubble_order[k]
                    if merge_size[j] >= a or not age[j] >= bubbles.merge_age:
                        continue
                    reach = bubble_radius[i] + bubble_radius[j]
                    dx = real(position[0, i] - position[0, j])
                    dy = real(position[1, i] - position[1, j])
                    dz = real(position[2, i] - position[2, j])
                    if squared_distance(dx, dy, dz) <= reach * reach:
                        _unite(merge_root, merge_size, i, j)
    for a in range(bubble_count[0]):  # a parent comes earlier in the list, and knows its root by then
        i = bubble_index[a]
        merge_root[i] = merge_root[merge_root[i]]
        merge_size[i] = 0
    for a in range(bubble_count[0]):
        merge_size[merge_root[bubble_index[a]]] += 1


@cpu_stage
def merge_bubbles(
    bubble_index, bubble_count, merge_root, merge_size, bubbles,
    phase, position, velocity, rest_volume, bubble_volume, bubble_radius, birth_height, age, cargo, merge_removed,
):
    """See `melt.reference.bubble_merge.merge_bubbles`; roots read their members before these are cleared."""
    real = type(bubbles.spacing)
    wide = position.dtype.type
    count, pieces = int(bubble_count[0]), merge_removed.shape[1]
    for p in prange(pieces):
        mu = mv = 0.0
        for a in range(p * count // pieces, (p + 1) * count // pieces):
            j = bubble_index[a]
            if bubbles.upward == 1 and merge_size[merge_root[j]] > 1:
                inertia = np.float64(bubbles.inertia) * current_volume(bubble_volume[j], bubble_radius[j])
                mu += inertia * np.float64(velocity[0, j])
                mv += inertia * np.float64(velocity[1, j])
        merge_removed[0, p], merge_removed[1, p], merge_removed[2, p] = mu, mv, 0.0
    for a in prange(count):
        i = bubble_index[a]
        if merge_size[i] > 1:
            V, x, y, z, u, v, w, px, py, pz, carried = merged_sums(
                a, bubble_index, bubble_count, merge_root, merge_size, bubble_volume, bubble_radius, position, velocity,
                cargo,
            )
            part = np.float64(merge_size[i])
            x, y, z = (px / part, py / part, pz / part) if bubbles.plain_mean == 1 else (x / V, y / V, z / V)
            position[0, i], position[1, i], position[2, i] = wide(x), wide(y), wide(z)
            level = bubbles.upward == 1
            velocity[0, i] = real(0) if level else real(u / V)
            velocity[1, i] = real(0) if level else real(v / V)
            velocity[2, i] = real(w / V)
            bubble_volume[i] = V
            bubble_radius[i] = real(radius_of(V))
            rest_volume[i] = min(real(V), bubbles.most_volume)
            birth_height[i] = real(z - np.float64(bubbles.floor))
            age[i] = bubbles.merge_age
            cargo[i] = carried
    for a in prange(count):
        j = bubble_index[a]
        if merge_root[j] != j:
            phase[j] = INACTIVE
            bubble_volume[j] = 0.0
            bubble_radius[j] = rest_volume[j] = real(0)
            cargo[j] = 0
