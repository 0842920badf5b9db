"""Rows of the viscous system, for the CPU stages that set it up, that start and that apply it.

Set-up is in loops of one purpose: one that wrote w and summed the block in float64 did not vectorise
(11.8 against 8.6 ms at 59,319 particles with 31 neighbours, float32, one thread).
"""

import numpy as np

from melt._compile import cpu_helper
from melt.physics.period import wrap
from melt.physics.smoothing import dW_over_r
from melt.physics.viscous import shear_factor


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


@cpu_helper
def fill_shear(i, position, volume, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period, pair_shear):
    """Write w_ij of particle i."""
    real = type(smoothing.support)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    mu_i, V_i = viscosity[i], volume[i]
    for k in range(np.uint64(neighbour_count[i])):
        j = np.uint64(neighbour_index[i, k])
        x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
        y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
        z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
        c = shear_factor(mu_i, viscosity[j], V_i, volume[j], x * x + y * y + z * z, smoothing, viscous)
        pair_shear[0, i, k] = c * x
        pair_shear[1, i, k] = c * y
        pair_shear[2, i, k] = c * z


@cpu_helper
def outer_shear(i, neighbour_count, pair_shear):
    """Return sum_j w_ij w_ij^T in float64."""
    wide = np.float64
    xx = yy = zz = xy = xz = yz = wide(0)
    for k in range(np.uint64(neighbour_count[i])):
        x, y, z = wide(pair_shear[0, i, k]), wide(pair_shear[1, i, k]), wide(pair_shear[2, i, k])
        xx += x * x
        yy += y * y
        zz += z * z
        xy += x * y
        xz += x * z
        yz += y * z
    return xx, yy, zz, xy, xz, yz


@cpu_helper
def outer_dilation(i, position, volume, mobility, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period):
    """Return in float64 the sum over free j of V_j gamma_j (V_i/V_j)^2 g_ij g_ij^T, and G = sum_j g_ij.

    y_j of the augmented Lagrangian moves with v_i only if j is free.
    """
    real = type(smoothing.support)
    wide = np.float64
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    own = viscous.gamma * volume[i] * volume[i]
    xx = yy = zz = xy = xz = yz = gx = gy = gz = wide(0)
    for k in range(np.uint64(neighbour_count[i])):
        j = np.uint64(neighbour_index[i, k])
        x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
        y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
        z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
        f = dW_over_r(x * x + y * y + z * z, smoothing)
        g = volume[j] * f
        s = wide(own * viscosity[j] * g * f if mobility[j] > real(0) else real(0))
        X, Y, Z = wide(x), wide(y), wide(z)
        gx += wide(g) * X
        gy += wide(g) * Y
        gz += wide(g) * Z
        xx += s * X * X
        yy += s * Y * Y
        zz += s * Z * Z
        xy += s * X * Y
        xz += s * X * Z
        yz += s * Y * Z
    return xx, yy, zz, xy, xz, yz, gx, gy, gz
