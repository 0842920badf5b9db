"""CPU twin of `melt.reference.pbf_lists`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.pbf import support_of
from melt.physics.phases import BUBBLE, LIQUID
from melt.physics.philox import pair_direction
from melt.physics.search import squared_distance


@cpu_stage
def pbf_begin(phase, mass, rest_volume, volume, mobility, constraint, multiplier):
    """See `melt.reference.pbf_lists.pbf_begin`."""
    real = mass.dtype.type
    for i in prange(phase.shape[0]):
        volume[i] = rest_volume[i] if phase[i] <= BUBBLE else real(0)
        mobility[i] = real(1) / mass[i] if phase[i] == LIQUID else real(0)
        constraint[i] = multiplier[i] = real(0)


@cpu_stage
def pbf_list(position, support_radius, pbf, neighbour_count, neighbour_index):
    """See `melt.reference.pbf_lists.pbf_list`."""
    real = type(pbf.support)
    for i in prange(position.shape[1]):
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        kept = np.uint64(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            R = support_of(i, j, support_radius, pbf)
            neighbour_index[i, kept] = np.int32(j)  # never ahead of k: appends without a branch
            kept += np.uint64(squared_distance(x, y, z) < R * R or R == real(0))
        neighbour_count[i] = np.int32(kept)


@cpu_stage
def pbf_separate(position, id, mobility, neighbour_count, neighbour_index, pbf, correction):
    """See `melt.reference.pbf_lists.pbf_separate`."""
    real = type(pbf.support)
    tiny = real(1e-18) * pbf.spacing * pbf.spacing
    step = real(0.01) * pbf.spacing
    for i in prange(position.shape[1]):
        dx = dy = dz = real(0)
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        # nearly all stand alone: one loop without branches tells them
        least = pbf.support * pbf.support
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x, y, z = real(x_i - position[0, j]), real(y_i - position[1, j]), real(z_i - position[2, j])
            least = min(least, x * x + y * y + z * z)
        for k in range(np.uint64(neighbour_count[i] if least <= tiny and mobility[i] > real(0) else 0)):
            j = np.uint64(neighbour_index[i, k])
            x, y, z = real(x_i - position[0, j]), real(y_i - position[1, j]), real(z_i - position[2, j])
            if x * x + y * y + z * z <= tiny:
                share = step * mobility[i] / (mobility[i] + mobility[j])
                u, v, w = pair_direction(id[i], id[j], share)
                dx += share * u
                dy += share * v
                dz += share * w
        correction[0, i], correction[1, i], correction[2, i] = dx, dy, dz
