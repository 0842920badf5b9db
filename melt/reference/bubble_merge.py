"""Merging of bubbles that overlap: connected components, and the bubble that each becomes. Boiling spec 2.5, 3."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def bubble_cell(position, phase, grid, coarse, bubble_cell):
    """Write the coarse cell of each bubble, blocks of ``coarse`` grid cells along each axis, x fastest.

    Like the grid's cells it is a bin, defined in the precision of the positions. All that are no bubbles get the
    number behind the last grid cell.

    Reads: position (3, n) [m], phase (n,). Writes: bubble_cell (n,).
    """
    real = position.dtype.type
    origin = grid.origin_x, grid.origin_y, grid.origin_z
    count = grid.nx, grid.ny, grid.nz
    c = []
    with np.errstate(invalid="ignore", over="ignore"):
        for a in range(3):
            t = (position[a] - real(origin[a])) * real(grid.inverse_cell)
            c.append(np.where(t > 0, np.minimum(t, count[a] - 1), 0).astype(np.int64) // coarse)
    blocks = [(int(m) - 1) // int(coarse) + 1 for m in count]
    linear = c[0] + blocks[0] * (c[1] + blocks[1] * c[2])
    bubble_cell[:] = np.where(phase == 3, linear, int(count[0]) * int(count[1]) * int(count[2]))


def merge_label(
    position, bubble_radius, age, bubble_index, bubble_count, bubble_cell, bubble_order, bubble_start,
    grid, bubbles, coarse, merge_root, merge_size,
):
    r"""Write for each bubble the first of the list that it merges with: chains of :math:`|x_a - x_b| \le r_a + r_b`.

    Bubbles younger than t_imm merge with none. Here over all pairs; the cells are for the twins.

    Reads: position (3, n) [m], bubble_radius (n,) [m], age (n,) [s], bubble_index (n,) by ascending id.
    Writes: merge_root (n,), a slot, -1 for others than bubbles; merge_size (n,), the members at the root, else 0.
    """
    merge_root[:], merge_size[:] = -1, 0
    slots = bubble_index[: int(bubble_count[0])]
    if slots.size == 0:
        return
    x, r = position[:, slots].astype(np.float64), bubble_radius[slots].astype(np.float64)
    apart2 = ((x[:, :, None] - x[:, None, :]) ** 2).sum(axis=0)
    old = age[slots] >= bubbles.merge_age
    near = (apart2 <= (r[:, None] + r[None, :]) ** 2) & old[:, None] & old[None, :]
    label = connected_components(coo_array(near), directed=False)[1]
    for component in range(label.max() + 1):
        members = slots[label == component]
        merge_root[members], merge_size[members[0]] = members[0], members.size


def _volumes(V0, r):
    """Volumes now: V0 where r is its rounded radius (to 8 ulp of r), else (4/3) pi r^3."""
    born = np.cbrt(0.75 / np.pi * V0).astype(r.dtype)
    return np.where(np.abs(r - born) <= 8 * np.finfo(r.dtype).eps * born, V0, 4 / 3 * np.pi * r.astype(np.float64) ** 3)


def merge_bubbles(
    bubble_index, bubble_count, merge_root, merge_size, bubbles,
    phase, position, velocity, rest_volume, bubble_volume, bubble_radius, birth_height, age, cargo, merge_removed,
):
    r"""Make one bubble of each component; it keeps the slot and id of its root, the others vanish.

    .. math:: V_0 = \sum V_i, \quad v = \sum I_i v_i / \sum I_i, \quad x = \sum V_i x_i / \sum V_i

    with the volumes V of now and the inertia I = (rho_g + C_A rho_0) V. Born anew: at its height, of age t_imm.
    ``plain_mean``: x is the mean of the x_i. ``upward``: v keeps its vertical part only.

    Reads: bubble_index (n,) by ascending id, merge_root, merge_size (n,).
    Writes: the fields of all members; merge_removed (3, 64) [kg m/s], what ``upward`` took from the members, by
        their places in the list.
    """
    slots = bubble_index[: int(bubble_count[0])]
    V = _volumes(bubble_volume[slots], bubble_radius[slots])
    x, v = position[:, slots].astype(np.float64), velocity[:, slots].astype(np.float64)
    removed = np.zeros((3, slots.size))
    for root in slots[merge_size[slots] > 1]:
        on = merge_root[slots] == root
        total = V[on].sum()
        place = x[:, on].mean(axis=1) if bubbles.plain_mean == 1 else (V[on] * x[:, on]).sum(axis=1) / total
        speed = (V[on] * v[:, on]).sum(axis=1) / total
        if bubbles.upward == 1:
            speed[:2] = 0
            removed[:2, on] = float(bubbles.inertia) * V[on] * v[:2, on]
        position[:, root], velocity[:, root] = place, speed
        bubble_volume[root], bubble_radius[root] = total, np.cbrt(0.75 / np.pi * total)
        rest_volume[root] = min(total, float(bubbles.most_volume))
        birth_height[root], age[root] = place[2] - float(bubbles.floor), bubbles.merge_age
        gone = slots[on & (slots != root)]
        cargo[root] += cargo[gone].sum()
        phase[gone] = 5
        bubble_volume[gone] = bubble_radius[gone] = rest_volume[gone] = cargo[gone] = 0
    pieces = merge_removed.shape[1]
    for p in range(pieces):
        part = slice(p * slots.size // pieces, (p + 1) * slots.size // pieces)
        merge_removed[:, p] = removed[:, part].sum(axis=1)
