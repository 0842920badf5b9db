"""CPU twin of `melt.reference.dfsph_source`. Sums: 64 shares of particles, added in order."""

import numpy as np

from melt._compile import cpu_stage, prange


@cpu_stage
def divergence_source(
    velocity, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt, compression_source,
):
    """See `melt.reference.dfsph_source.divergence_source`."""
    real = type(dt)
    capacity = neighbour_index.shape[1]
    n = dfsph_factor.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: walls have no pairs
        for i in range(piece * n // 64, (piece + 1) * n // 64):
            source = real(0)
            if dfsph_factor[i] > real(0):
                u, v, w, change = velocity[0, i], velocity[1, i], velocity[2, i], real(0)
                for k in range(np.uint64(min(neighbour_count[i], capacity))):
                    j = np.uint64(neighbour_index[i, k])
                    change += (
                        pair_gradient[0, i, k] * (u - velocity[0, j])
                        + pair_gradient[1, i, k] * (v - velocity[1, j])
                        + pair_gradient[2, i, k] * (w - velocity[2, j])
                    )
                source = dt * change if neighbour_count[i] >= dfsph.fewest else real(-1e6)
            compression_source[i] = source


@cpu_stage
def density_source(
    velocity, completed_ratio, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dt, compression_source,
):
    """See `melt.reference.dfsph_source.density_source`."""
    real = type(dt)
    capacity = neighbour_index.shape[1]
    n = dfsph_factor.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: walls have no pairs
        for i in range(piece * n // 64, (piece + 1) * n // 64):
            source = real(0)
            if dfsph_factor[i] > real(0):
                u, v, w, change = velocity[0, i], velocity[1, i], velocity[2, i], real(0)
                for k in range(np.uint64(min(neighbour_count[i], capacity))):
                    j = np.uint64(neighbour_index[i, k])
                    change += (
                        pair_gradient[0, i, k] * (u - velocity[0, j])
                        + pair_gradient[1, i, k] * (v - velocity[1, j])
                        + pair_gradient[2, i, k] * (w - velocity[2, j])
                    )
                source = (completed_ratio[i] - real(1)) + dt * change
            compression_source[i] = source


@cpu_stage
def source_mean(compression_source, dfsph_factor, source_sums):
    """See `melt.reference.dfsph_source.source_mean`."""
    real = dfsph_factor.dtype.type
    n = dfsph_factor.shape[0]
    for share in prange(64):
        total, number = 0.0, 0.0
        for i in range(share * n // 64, (share + 1) * n // 64):
            if dfsph_factor[i] > real(0) and not compression_source[i] <= real(-1e5):
                total += np.float64(compression_source[i])
                number += 1.0
        source_sums[0, share], source_sums[1, share] = total, number


@cpu_stage
def shift_source(shift, compression_source):
    """See `melt.reference.dfsph_source.shift_source`."""
    for i in prange(compression_source.shape[0]):
        compression_source[i] -= shift
