"""CUDA twin of `melt.reference.pbf_lists`."""

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.physics.pbf import support_of
from melt.physics.phases import BUBBLE, LIQUID
from melt.physics.philox import pair_direction
from melt.physics.search import squared_distance


@cuda_kernel
def _pbf_begin(phase, mass, rest_volume, volume, mobility, constraint, multiplier):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = mass.dtype.type
    volume[i] = rest_volume[i] if phase[i] <= BUBBLE else real(0)
    mobility[i] = real(1) / mass[i] if phase[i] == LIQUID else real(0)
    constraint[i] = multiplier[i] = real(0)


def pbf_begin(phase, mass, rest_volume, volume, mobility, constraint, multiplier):
    """See `melt.reference.pbf_lists.pbf_begin`."""
    _pbf_begin.launch(phase.shape[0], phase, mass, rest_volume, volume, mobility, constraint, multiplier)


@cuda_kernel
def _pbf_list(position, support_radius, pbf, neighbour_count, neighbour_index):
    i = cuda.grid(1)
    if i >= position.shape[1]:
        return
    real = type(pbf.support)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    kept = np.uint64(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        R = support_of(i, j, support_radius, pbf)
        neighbour_index[i, kept] = np.int32(j)  # never ahead of k: appends without a branch
        kept += np.uint64(squared_distance(x, y, z) < R * R or R == real(0))
    neighbour_count[i] = np.int32(kept)


def pbf_list(position, support_radius, pbf, neighbour_count, neighbour_index):
    """See `melt.reference.pbf_lists.pbf_list`."""
    _pbf_list.launch(position.shape[1], position, support_radius, pbf, neighbour_count, neighbour_index)


@cuda_kernel
def _pbf_separate(position, id, mobility, neighbour_count, neighbour_index, pbf, correction):
    i = cuda.grid(1)
    if i >= position.shape[1]:
        return
    real = type(pbf.support)
    tiny = real(1e-18) * pbf.spacing * pbf.spacing
    step = real(0.01) * pbf.spacing
    dx = dy = dz = real(0)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    # nearly all stand alone: one loop without branches tells them
    least = pbf.support * pbf.support
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x, y, z = real(x_i - position[0, j]), real(y_i - position[1, j]), real(z_i - position[2, j])
        least = min(least, x * x + y * y + z * z)
    for k in range(neighbour_count[i] if least <= tiny and mobility[i] > real(0) else 0):
        j = neighbour_index[i, k]
        x, y, z = real(x_i - position[0, j]), real(y_i - position[1, j]), real(z_i - position[2, j])
        if x * x + y * y + z * z <= tiny:
            share = step * mobility[i] / (mobility[i] + mobility[j])
            u, v, w = pair_direction(id[i], id[j], share)
            dx += share * u
            dy += share * v
            dz += share * w
    correction[0, i], correction[1, i], correction[2, i] = dx, dy, dz


def pbf_separate(position, id, mobility, neighbour_count, neighbour_index, pbf, correction):
    """See `melt.reference.pbf_lists.pbf_separate`."""
    _pbf_separate.launch(
        position.shape[1], position, id, mobility, neighbour_count, neighbour_index, pbf, correction,
    )
