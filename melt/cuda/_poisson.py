"""Sums over particles of the pressure Poisson equation."""

from melt._compile import cuda, cuda_kernel


@cuda_kernel
def dot(a, b, row, sums):
    """Write the partial sums of the product of two scalar fields into a row of ``sums``."""
    share = cuda.grid(1)
    if share >= 64:
        return
    n = a.shape[0]
    wide = sums.dtype.type
    total = wide(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        total += wide(a[i]) * wide(b[i])
    sums[row, share] = total
