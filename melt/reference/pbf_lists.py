r"""Roles of particles in the position solve, short neighbour lists, coincident particles. Boiling spec 2.1, 2.6, 6."""

import numpy as np

from melt.reference._pbf import pair_supports
from melt.reference._philox import pair_direction


def pbf_begin(phase, mass, rest_volume, volume, mobility, constraint, multiplier):
    """Write volume and inverse mass by which particles enter the solve, and clear its unknowns.

    Reads: phase (n,), mass (n,) [kg], rest_volume (n,) [m^3].
    Writes: volume (n,) [m^3], 0 for vapour and inactive; mobility (n,) [1/kg], 0 for others than liquid;
        constraint (n,) and multiplier (n,), all 0.
    """
    volume[:] = np.where(phase <= 3, rest_volume, 0.0)
    liquid = phase == 0
    mobility[:] = np.where(liquid, 1 / np.where(liquid, mass.astype(np.float64), 1.0), 0.0)
    constraint[:] = 0
    multiplier[:] = 0


def pbf_list(position, support_radius, pbf, neighbour_count, neighbour_index):
    """Keep in each list only the neighbours closer than R_ij = (R_i + R_j)/2, in their order.

    Reads: position (3, n) [m], support_radius (n,) [m]; lists of all neighbours within R.
    Pairs without any radius (two bubbles, a bubble and a wall) stay.

    Writes: neighbour_count (n,), neighbour_index (n, capacity); entries behind the count mean nothing.
    """
    x = position.astype(np.float64)
    R = pair_supports(position, support_radius, pbf)
    for i in range(position.shape[1]):
        row = neighbour_index[i, : neighbour_count[i]].copy()
        r2 = ((x[:, i, None] - x[:, row]) ** 2).sum(axis=0)
        row = row[(r2 < R[i, row] ** 2) | (R[i, row] == 0)]
        neighbour_count[i] = row.size
        neighbour_index[i, : row.size] = row


def pbf_separate(position, id, mobility, neighbour_count, neighbour_index, pbf, correction):
    """Write what moves apart particles at one place: no kernel gradient can.

    Each is moved by 0.01 d w_i/(w_i + w_j) along a direction that follows from both ids, opposite for the two.

    Reads: position (3, n) [m], id (n,), mobility (n,) [1/kg], neighbour lists.
    Writes: correction (3, n) [m], 0 for all that stand alone.
    """
    correction[:] = 0
    x = position.astype(np.float64)
    w = mobility.astype(np.float64)
    step = 0.01 * float(pbf.spacing)
    for i in np.flatnonzero(w > 0):
        for j in neighbour_index[i, : neighbour_count[i]]:
            if ((x[:, i] - x[:, j]) ** 2).sum() <= (1e-9 * float(pbf.spacing)) ** 2:
                direction = pair_direction(int(id[i]), int(id[j]))
                correction[:, i] += step * w[i] / (w[i] + w[j]) * np.array(direction)
