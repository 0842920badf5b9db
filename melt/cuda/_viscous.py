"""Rows of the viscous system, for the kernels that start and that apply it, and sums over particles."""

from melt._compile import cuda, cuda_kernel, scalar_lookup


@scalar_lookup
def shear_row(i, neighbour_count, neighbour_index, pair_shear, v):
    """Return (K v)_i."""
    fx = fy = fz = pair_shear.dtype.type(0)
    u_i, v_i, w_i = v[0, i], v[1, i], v[2, i]
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        wx, wy, wz = pair_shear[0, i, k], pair_shear[1, i, k], pair_shear[2, i, k]
        f = wx * (u_i - v[0, j]) + wy * (v_i - v[1, j]) + wz * (w_i - v[2, j])
        fx += f * wx
        fy += f * wy
        fz += f * wz
    return fx, fy, fz


@scalar_lookup
def adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, y):
    """Return (D^T V y)_i."""
    fx = fy = fz = pair_gradient.dtype.type(0)
    y_i = y[i]
    for k in range(neighbour_count[i]):
        f = y_i + y[neighbour_index[i, k]]
        fx += f * pair_gradient[0, i, k]
        fy += f * pair_gradient[1, i, k]
        fz += f * pair_gradient[2, i, k]
    V = volume[i]
    return -V * fx, -V * fy, -V * fz


@cuda_kernel
def dot(a, b, row, sums):
    """Write the partial sums of the product of two vector fields into a row of ``sums``."""
    share = cuda.grid(1)
    if share >= 64:
        return
    n = a.shape[1]
    wide = sums.dtype.type
    total = wide(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        total += wide(a[0, i]) * wide(b[0, i]) + wide(a[1, i]) * wide(b[1, i]) + wide(a[2, i]) * wide(b[2, i])
    sums[row, share] = total
