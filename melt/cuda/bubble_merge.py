"""CUDA twin of `melt.reference.bubble_merge`."""

import numpy as np

from melt._compile import cuda, cuda_kernel, device_empty
from melt.physics.bubble_life import coarse_cell, coarse_count, current_volume, merged_sums
from melt.physics.bubbles import radius_of
from melt.physics.phases import BUBBLE, INACTIVE
from melt.physics.search import squared_distance


@cuda_kernel
def _bubble_cell(position, phase, grid, coarse, bubble_cell):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    cell = int(grid.nx) * int(grid.ny) * int(grid.nz)
    if phase[i] == BUBBLE:
        cell = coarse_cell(position[0, i], position[1, i], position[2, i], grid, coarse)
    bubble_cell[i] = cell


def bubble_cell(position, phase, grid, coarse, bubble_cell):
    """See `melt.reference.bubble_merge.bubble_cell`."""
    _bubble_cell.launch(phase.shape[0], position, phase, grid, coarse, bubble_cell)


@cuda_kernel
def _no_label(merge_root, merge_size):
    i = cuda.grid(1)
    if i < merge_root.shape[0]:
        merge_root[i] = -1
        merge_size[i] = 0


@cuda_kernel
def _own_label(bubble_index, bubble_count, label):
    a = cuda.grid(1)
    if a < bubble_count[0]:
        label[bubble_index[a]] = a


@cuda_kernel
def _hook(
    position, bubble_radius, age, bubble_index, bubble_count, bubble_cell, bubble_order, bubble_start,
    grid, bubbles, coarse, label, changed,
):
    """Lower the label of a bubble's root to the smallest label that overlaps it (see `melt.cuda.components`)."""
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    real = type(bubbles.spacing)
    i = bubble_index[a]
    if not age[i] >= bubbles.merge_age:
        return
    nx, ny, nz = coarse_count(grid.nx, coarse), coarse_count(grid.ny, coarse), coarse_count(grid.nz, coarse)
    own = label[i]
    least = own
    c = bubble_cell[i]
    cx, cy, cz = c % nx, c // nx % ny, c // (nx * ny)
    for z in range(max(cz - 1, 0), min(cz + 2, nz)):
        for y in range(max(cy - 1, 0), min(cy + 2, ny)):
            row = nx * (y + ny * z)
            for k in range(bubble_start[row + max(cx - 1, 0)], bubble_start[row + min(cx + 2, nx)]):
                j = bubble_order[k]
                if not age[j] >= bubbles.merge_age:
                    continue
                reach = bubble_radius[i] + bubble_radius[j]
                dx = real(position[0, i] - position[0, j])
                dy = real(position[1, i] - position[1, j])
                dz = real(position[2, i] - position[2, j])
                if squared_distance(dx, dy, dz) <= reach * reach:
                    least = min(least, label[j])
    if least < own:
        cuda.atomic.min(label, bubble_index[own], least)
        cuda.atomic.min(label, i, least)
        cuda.atomic.max(changed, 0, 1)


@cuda_kernel
def _jump(bubble_index, bubble_count, label):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    root = label[bubble_index[a]]
    while label[bubble_index[root]] != root:
        root = label[bubble_index[root]]
    label[bubble_index[a]] = root


@cuda_kernel
def _roots(bubble_index, bubble_count, merge_root, merge_size):
    """Turn places in the list into slots, and count."""
    a = cuda.grid(1)
    if a < bubble_count[0]:
        i = bubble_index[a]
        root = bubble_index[merge_root[i]]
        merge_root[i] = root
        cuda.atomic.add(merge_size, root, 1)


def merge_label(
    position, bubble_radius, age, bubble_index, bubble_count, bubble_cell, bubble_order, bubble_start,
    grid, bubbles, coarse, merge_root, merge_size,
):
    """See `melt.reference.bubble_merge.merge_label`; reads one flag back per pass.

    Labels are places in the list, so that the smallest id wins; they become slots at the end.
    """
    n = bubble_index.shape[0]
    _no_label.launch(n, merge_root, merge_size)
    _own_label.launch(n, bubble_index, bubble_count, merge_root)
    changed = device_empty(1, merge_root.dtype)
    more = n > 0
    while more:
        changed[0] = 0
        _hook.launch(
            n, position, bubble_radius, age, bubble_index, bubble_count, bubble_cell, bubble_order, bubble_start,
            grid, bubbles, coarse, merge_root, changed,
        )
        _jump.launch(n, bubble_index, bubble_count, merge_root)
        more = bool(changed[0])
    _roots.launch(n, bubble_index, bubble_count, merge_root, merge_size)


@cuda_kernel
def _merge_removed(
    bubble_index, bubble_count, merge_root, merge_size, bubbles, velocity, bubble_volume, bubble_radius, merge_removed
):
    p = cuda.grid(1)
    count, pieces = int(bubble_count[0]), merge_removed.shape[1]
    if p >= pieces:
        return
    mu = mv = np.float64(0)
    for a in range(p * count // pieces, (p + 1) * count // pieces):
        j = bubble_index[a]
        if bubbles.upward == 1 and merge_size[merge_root[j]] > 1:
            inertia = np.float64(bubbles.inertia) * current_volume(bubble_volume[j], bubble_radius[j])
            mu += inertia * np.float64(velocity[0, j])
            mv += inertia * np.float64(velocity[1, j])
    merge_removed[0, p], merge_removed[1, p], merge_removed[2, p] = mu, mv, np.float64(0)


@cuda_kernel
def _merge_members(
    bubble_index, bubble_count, merge_root, merge_size, bubbles,
    position, velocity, rest_volume, bubble_volume, bubble_radius, birth_height, age, cargo,
):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    i = bubble_index[a]
    if merge_size[i] <= 1:
        return
    real = type(bubbles.spacing)
    wide = position.dtype.type
    V, x, y, z, u, v, w, px, py, pz, carried = merged_sums(
        a, bubble_index, bubble_count, merge_root, merge_size, bubble_volume, bubble_radius, position, velocity, cargo
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


@cuda_kernel
def _clear_members(
    bubble_index, bubble_count, merge_root, phase, rest_volume, bubble_volume, bubble_radius, cargo
):
    a = cuda.grid(1)
    if a >= bubble_count[0] or merge_root[bubble_index[a]] == bubble_index[a]:
        return
    j = bubble_index[a]
    phase[j] = INACTIVE
    bubble_volume[j] = np.float64(0)
    bubble_radius[j] = rest_volume[j] = rest_volume.dtype.type(0)
    cargo[j] = 0


def merge_bubbles(
    bubble_index, bubble_count, merge_root, merge_size, bubbles,
    phase, position, velocity, rest_volume, bubble_volume, bubble_radius, birth_height, age, cargo, merge_removed,
):
    """See `melt.reference.bubble_merge.merge_bubbles`; roots read their members before these are cleared."""
    n = bubble_index.shape[0]
    _merge_removed.launch(
        merge_removed.shape[1], bubble_index, bubble_count, merge_root, merge_size, bubbles, velocity, bubble_volume,
        bubble_radius, merge_removed,
    )
    _merge_members.launch(
        n, bubble_index, bubble_count, merge_root, merge_size, bubbles,
        position, velocity, rest_volume, bubble_volume, bubble_radius, birth_height, age, cargo,
    )
    _clear_members.launch(
        n, bubble_index, bubble_count, merge_root, phase, rest_volume, bubble_volume, bubble_radius, cargo
    )
