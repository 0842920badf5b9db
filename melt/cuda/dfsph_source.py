"""CUDA twin of `melt.reference.dfsph_source`. Sums: one thread for each of 64 shares, added in order."""

from melt._compile import cuda, cuda_kernel


@cuda_kernel
def _divergence_source(
    velocity, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt, compression_source,
):
    i = cuda.grid(1)
    if i >= dfsph_factor.shape[0]:
        return
    real = type(dt)
    if not dfsph_factor[i] > real(0):
        compression_source[i] = real(0)
        return
    u, v, w, change = velocity[0, i], velocity[1, i], velocity[2, i], real(0)
    for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
        j = neighbour_index[i, k]
        change += (
            pair_gradient[0, i, k] * (u - velocity[0, j])
            + pair_gradient[1, i, k] * (v - velocity[1, j])
            + pair_gradient[2, i, k] * (w - velocity[2, j])
        )
    compression_source[i] = dt * change if neighbour_count[i] >= dfsph.fewest else real(-1e6)


def divergence_source(
    velocity, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt, compression_source,
):
    """See `melt.reference.dfsph_source.divergence_source`."""
    _divergence_source.launch(
        dfsph_factor.shape[0], velocity, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt,
        compression_source,
    )


@cuda_kernel
def _density_source(
    velocity, completed_ratio, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dt, compression_source,
):
    i = cuda.grid(1)
    if i >= dfsph_factor.shape[0]:
        return
    real = type(dt)
    if not dfsph_factor[i] > real(0):
        compression_source[i] = real(0)
        return
    u, v, w, change = velocity[0, i], velocity[1, i], velocity[2, i], real(0)
    for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
        j = neighbour_index[i, k]
        change += (
            pair_gradient[0, i, k] * (u - velocity[0, j])
            + pair_gradient[1, i, k] * (v - velocity[1, j])
            + pair_gradient[2, i, k] * (w - velocity[2, j])
        )
    compression_source[i] = (completed_ratio[i] - real(1)) + dt * change


def density_source(
    velocity, completed_ratio, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dt, compression_source,
):
    """See `melt.reference.dfsph_source.density_source`."""
    _density_source.launch(
        dfsph_factor.shape[0], velocity, completed_ratio, dfsph_factor, neighbour_count, neighbour_index, pair_gradient,
        dt, compression_source,
    )


@cuda_kernel
def _source_mean(compression_source, dfsph_factor, source_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    real = dfsph_factor.dtype.type
    double = source_sums.dtype.type
    n = dfsph_factor.shape[0]
    total = number = double(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        if dfsph_factor[i] > real(0) and not compression_source[i] <= real(-1e5):
            total += double(compression_source[i])
            number += double(1)
    source_sums[0, share], source_sums[1, share] = total, number


def source_mean(compression_source, dfsph_factor, source_sums):
    """See `melt.reference.dfsph_source.source_mean`."""
    _source_mean.launch(64, compression_source, dfsph_factor, source_sums)


@cuda_kernel
def _shift_source(shift, compression_source):
    i = cuda.grid(1)
    if i < compression_source.shape[0]:
        compression_source[i] -= shift


def shift_source(shift, compression_source):
    """See `melt.reference.dfsph_source.shift_source`."""
    _shift_source.launch(compression_source.shape[0], shift, compression_source)
