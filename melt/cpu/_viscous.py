"""Rows of the viscous system, for the CPU stages that start and that apply it."""

import numpy as np

from melt._compile import cpu_helper


@cpu_helper
def shear_row(i, neighbour_count, neighbour_index, pair_shear, v):
    """Return (K v)_i."""
    fx = fy = fz = pair_shear.dtype.type(0)
    u_i, v_i, w_i = v[0, i], v[1, i], v[2, i]
    for k in range(np.uint64(neighbour_count[i])):
        j = np.uint64(neighbour_index[i, k])
        wx, wy, wz = pair_shear[0, i, k], pair_shear[1, i, k], pair_shear[2, i, k]
        f = wx * (u_i - v[0, j]) + wy * (v_i - v[1, j]) + wz * (w_i - v[2, j])
        fx += f * wx
        fy += f * wy
        fz += f * wz
    return fx, fy, fz


@cpu_helper
def adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, y):
    """Return (D^T V y)_i."""
    fx = fy = fz = pair_gradient.dtype.type(0)
    y_i = y[i]
    for k in range(np.uint64(neighbour_count[i])):
        f = y_i + y[np.uint64(neighbour_index[i, k])]
        fx += f * pair_gradient[0, i, k]
        fy += f * pair_gradient[1, i, k]
        fz += f * pair_gradient[2, i, k]
    V = volume[i]
    return -V * fx, -V * fy, -V * fz
