r"""What a pressure solve of DFSPH has to remove, as a density ratio. Slime spec 2.7, in the volume form.

.. math:: \text{divergence: } \Delta t \frac{D s_i}{D t}, \qquad
          \text{density: } s^c_i - 1 + \Delta t \frac{D s_i}{D t}, \qquad
          \frac{D s_i}{D t} = \sum_j \vec g_{ij} \cdot (\vec v_i - \vec v_j)
"""

import numpy as np

from melt.reference._shares import rows, shares

NO_PRESSURE = -1e6  # the source where the divergence is not corrected; below SKIPPED = -1e5 of the solver


def _change(velocity, neighbour_count, neighbour_index, pair_gradient):
    """Return D s_i/Dt (n,) [1/s]."""
    v = velocity.astype(np.float64)
    change = np.zeros(v.shape[1])
    for i, near in rows(neighbour_count, neighbour_index):
        g = pair_gradient[:, i, : len(near)].astype(np.float64)
        change[i] = (g * (v[:, i : i + 1] - v[:, near])).sum()
    return change


def divergence_source(
    velocity, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt, compression_source,
):
    """Write dt D s/Dt; -1e6 with fewer neighbours than ``fewest``, whose sum is no divergence; 0 without factor.

    Reads: velocity (3, n) [m/s], dfsph_factor (n,) [kg/m], the lists, pair_gradient (3, n, capacity) [1/m], dt [s].
    Writes: compression_source (n,).
    """
    change = float(dt) * _change(velocity, neighbour_count, neighbour_index, pair_gradient)
    change[neighbour_count < dfsph.fewest] = NO_PRESSURE
    compression_source[:] = np.where(dfsph_factor > 0, change, 0.0)


def density_source(
    velocity, completed_ratio, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dt, compression_source,
):
    """Write the density ratio that the velocity leads to, minus 1; 0 without factor.

    Reads: velocity (3, n) [m/s], completed_ratio (n,), dfsph_factor (n,) [kg/m], the lists,
        pair_gradient (3, n, capacity) [1/m], dt [s]. Writes: compression_source (n,).
    """
    change = float(dt) * _change(velocity, neighbour_count, neighbour_index, pair_gradient)
    compression_source[:] = np.where(dfsph_factor > 0, completed_ratio.astype(np.float64) - 1 + change, 0.0)


def source_mean(compression_source, dfsph_factor, source_sums):
    """Write 64 partial sums of the source, and how many particles they are of: those with a pressure.

    Reads: compression_source (n,), dfsph_factor (n,) [kg/m]. Writes: source_sums (2, 64).
    """
    act = (dfsph_factor > 0) & ~(compression_source <= -1e5)
    source_sums[0] = [s.sum() for s in shares(np.where(act, compression_source, 0.0).astype(np.float64))]
    source_sums[1] = [s.sum() for s in shares(act)]


def shift_source(shift, compression_source):
    """Take the mean off the source: a closed box has no pressure for it. All particles; those without factor do not care.

    Reads: shift, the mean. Writes: compression_source (n,).
    """
    compression_source[:] = compression_source.astype(np.float64) - float(shift)
