"""CUDA twin of `melt.reference.viscous`. Sums: one thread for each of 64 shares, added in order."""

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.cuda._viscous import adjoint_row, dot, shear_row
from melt.physics.period import wrap
from melt.physics.smoothing import dW_over_r
from melt.physics.viscous import block_times, inverse_block, shear_factor


@cuda_kernel
def _pair_shear(
    position, volume, mobility, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period, dt,
    pair_shear, viscous_block,
):
    i = cuda.grid(1)
    if i >= mobility.shape[0]:
        return
    real = type(smoothing.support)
    wide = np.float64
    mu_i, V_i = viscosity[i], volume[i]
    if not (mobility[i] > real(0) and mu_i > real(0)):
        for a in range(6):
            viscous_block[a, i] = real(0)
        for a in range(3):
            for k in range(neighbour_count[i]):
                pair_shear[a, i, k] = real(0)
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    xx = yy = zz = wide(1) / (wide(mobility[i]) * wide(dt))
    xy = xz = yz = gx = gy = gz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
        y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
        z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
        r2 = x * x + y * y + z * z
        mu_j, V_j = viscosity[j], volume[j]
        c = shear_factor(mu_i, mu_j, V_i, V_j, r2, smoothing, viscous)
        pair_shear[0, i, k] = c * x
        pair_shear[1, i, k] = c * y
        pair_shear[2, i, k] = c * z
        f = dW_over_r(r2, smoothing)
        g = V_j * f
        # y_j of the augmented Lagrangian moves with v_i only if j is free
        other = viscous.gamma * mu_j * (V_i * V_i) * g * f if mobility[j] > real(0) else real(0)
        s, X, Y, Z = wide(c * c + other), wide(x), wide(y), wide(z)
        gx += wide(g) * X
        gy += wide(g) * Y
        gz += wide(g) * Z
        xx += s * X * X
        yy += s * Y * Y
        zz += s * Z * Z
        xy += s * X * Y
        xz += s * X * Z
        yz += s * Y * Z
    own = wide(V_i * viscous.gamma * mu_i)
    block = inverse_block(
        xx + own * gx * gx, yy + own * gy * gy, zz + own * gz * gz,
        xy + own * gx * gy, xz + own * gx * gz, yz + own * gy * gz,
    )
    viscous_block[0, i], viscous_block[1, i], viscous_block[2, i] = real(block[0]), real(block[1]), real(block[2])
    viscous_block[3, i], viscous_block[4, i], viscous_block[5, i] = real(block[3]), real(block[4]), real(block[5])


def pair_shear(
    position, volume, mobility, viscosity, neighbour_count, neighbour_index, smoothing, viscous, period, dt,
    pair_shear, viscous_block,
):
    """See `melt.reference.viscous.pair_shear`. The block is summed in float64: it may be nearly of rank one."""
    _pair_shear.launch(
        mobility.shape[0], position, volume, mobility, viscosity, neighbour_count, neighbour_index, smoothing,
        viscous, period, dt, pair_shear, viscous_block,
    )


@cuda_kernel
def _dilation(
    velocity, viscosity, viscous_block, neighbour_count, neighbour_index, pair_gradient, viscous, dilation,
):
    i = cuda.grid(1)
    if i >= viscosity.shape[0]:
        return
    real = type(viscous.gamma)
    if not viscous_block[0, i] > real(0):
        dilation[i] = real(0)
        return
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    total = real(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        total += (
            pair_gradient[0, i, k] * (velocity[0, j] - u_i)
            + pair_gradient[1, i, k] * (velocity[1, j] - v_i)
            + pair_gradient[2, i, k] * (velocity[2, j] - w_i)
        )
    dilation[i] = viscous.gamma * viscosity[i] * total


def dilation(
    velocity, viscosity, viscous_block, neighbour_count, neighbour_index, pair_gradient, viscous, dilation,
):
    """See `melt.reference.viscous.dilation`."""
    _dilation.launch(
        viscosity.shape[0], velocity, viscosity, viscous_block, neighbour_count, neighbour_index, pair_gradient,
        viscous, dilation,
    )


@cuda_kernel
def _viscous_start(
    mass, volume, velocity, velocity_free, viscous_block, dilation, viscous_pressure, neighbour_count,
    neighbour_index, pair_gradient, pair_shear, dt, viscous_residual, viscous_direction,
):
    i = cuda.grid(1)
    if i >= mass.shape[0]:
        return
    real = type(dt)
    if not viscous_block[0, i] > real(0):
        for a in range(3):
            viscous_residual[a, i] = real(0)
            viscous_direction[a, i] = real(0)
        return
    c = mass[i] / dt
    fx, fy, fz = shear_row(i, neighbour_count, neighbour_index, pair_shear, velocity)
    x = c * (velocity_free[0, i] - velocity[0, i]) - fx
    y = c * (velocity_free[1, i] - velocity[1, i]) - fy
    z = c * (velocity_free[2, i] - velocity[2, i]) - fz
    if dilation.shape[0] > 0:
        px, py, pz = adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, viscous_pressure)
        qx, qy, qz = adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, dilation)
        x, y, z = x + (px - qx), y + (py - qy), z + (pz - qz)
    viscous_residual[0, i], viscous_residual[1, i], viscous_residual[2, i] = x, y, z
    x, y, z = block_times(viscous_block, i, x, y, z)
    viscous_direction[0, i], viscous_direction[1, i], viscous_direction[2, i] = x, y, z


@cuda_kernel
def _right_side(mass, velocity_free, viscous_block, dt, viscous_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    n = mass.shape[0]
    wide = viscous_sums.dtype.type
    total = wide(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        if viscous_block[0, i] > type(dt)(0):
            c = mass[i] / dt
            x, y, z = wide(c * velocity_free[0, i]), wide(c * velocity_free[1, i]), wide(c * velocity_free[2, i])
            total += x * x + y * y + z * z
    viscous_sums[4, share] = total


def viscous_start(
    mass, volume, velocity, velocity_free, viscous_block, dilation, viscous_pressure, neighbour_count,
    neighbour_index, pair_gradient, pair_shear, dt, viscous_residual, viscous_direction, viscous_sums,
):
    """See `melt.reference.viscous.viscous_start`."""
    _viscous_start.launch(
        mass.shape[0], mass, volume, velocity, velocity_free, viscous_block, dilation, viscous_pressure,
        neighbour_count, neighbour_index, pair_gradient, pair_shear, dt, viscous_residual, viscous_direction,
    )
    dot.launch(64, viscous_residual, viscous_direction, 0, viscous_sums)
    dot.launch(64, viscous_residual, viscous_residual, 3, viscous_sums)
    _right_side.launch(64, mass, velocity_free, viscous_block, dt, viscous_sums)
