"""CUDA twin of `melt.reference.apic_back`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.params import ORPHAN
from melt.physics.period import into_box, wrap
from melt.physics.phases import INACTIVE, LIQUID
from melt.physics.ranges import ROWS, cell_at, row_cells
from melt.physics.smoothing import W


@cuda_kernel
def _nodes_to_apic(
    position, phase, cell_start, velocity, velocity_kept, apic_phase, apic_position, apic_weight, apic_centre, apic_inverse,
    grid, period, apic, fluid, dt, apic_velocity, apic_affine,
):
    p = cuda.grid(1)
    if p >= apic_phase.shape[0]:
        return
    if apic_phase[p] == INACTIVE:
        return
    real = type(apic.support)
    if not apic_weight[p] > real(0):
        apic_velocity[0, p] += dt * fluid.gravity_x
        apic_velocity[1, p] += dt * fluid.gravity_y
        apic_velocity[2, p] += dt * fluid.gravity_z
        return
    x_p, y_p, z_p = apic_position[0, p], apic_position[1, p], apic_position[2, p]
    c_x, c_y, c_z = cell_at(x_p, y_p, z_p, grid)
    f = real(1) / apic_weight[p]
    u = v = q = a = b = c = xx = xy = xz = yx = yy = yz = zx = zy = zz = real(0)
    for k in range(ROWS):
        first, stop = row_cells(k, c_x, c_y, c_z, grid, period)
        for i in range(cell_start[first], cell_start[stop]):
            if phase[i] != LIQUID:
                continue
            x = real(wrap(position[0, i] - x_p, period.length_x, period.inverse_x))
            y = real(wrap(position[1, i] - y_p, period.length_y, period.inverse_y))
            z = real(wrap(position[2, i] - z_p, period.length_z, period.inverse_z))
            w = f * W(math.sqrt(x * x + y * y + z * z), apic)
            if apic.flip > real(0):
                a, b, c = a + w * velocity_kept[0, i], b + w * velocity_kept[1, i], c + w * velocity_kept[2, i]
            x, y, z = x - apic_centre[0, p], y - apic_centre[1, p], z - apic_centre[2, p]
            w_x, w_y, w_z = w * velocity[0, i], w * velocity[1, i], w * velocity[2, i]
            u, v, q = u + w_x, v + w_y, q + w_z
            xx, xy, xz = xx + w_x * x, xy + w_x * y, xz + w_x * z
            yx, yy, yz = yx + w_y * x, yy + w_y * y, yz + w_y * z
            zx, zy, zz = zx + w_z * x, zy + w_z * y, zz + w_z * z
    apic_velocity[0, p] = u + apic.flip * (apic_velocity[0, p] - a)
    apic_velocity[1, p] = v + apic.flip * (apic_velocity[1, p] - b)
    apic_velocity[2, p] = q + apic.flip * (apic_velocity[2, p] - c)
    d_xx, d_yy, d_zz = apic_inverse[0, p], apic_inverse[1, p], apic_inverse[2, p]
    d_xy, d_xz, d_yz = apic_inverse[3, p], apic_inverse[4, p], apic_inverse[5, p]
    apic_affine[0, p] = xx * d_xx + xy * d_xy + xz * d_xz
    apic_affine[1, p] = xx * d_xy + xy * d_yy + xz * d_yz
    apic_affine[2, p] = xx * d_xz + xy * d_yz + xz * d_zz
    apic_affine[3, p] = yx * d_xx + yy * d_xy + yz * d_xz
    apic_affine[4, p] = yx * d_xy + yy * d_yy + yz * d_yz
    apic_affine[5, p] = yx * d_xz + yy * d_yz + yz * d_zz
    apic_affine[6, p] = zx * d_xx + zy * d_xy + zz * d_xz
    apic_affine[7, p] = zx * d_xy + zy * d_yy + zz * d_yz
    apic_affine[8, p] = zx * d_xz + zy * d_yz + zz * d_zz


def nodes_to_apic(
    position, phase, cell_start, velocity, velocity_kept, apic_phase, apic_position, apic_weight, apic_centre, apic_inverse,
    grid, period, apic, fluid, dt, apic_velocity, apic_affine,
):
    """See `melt.reference.apic_back.nodes_to_apic`."""
    _nodes_to_apic.launch(
        apic_phase.shape[0], position, phase, cell_start, velocity, velocity_kept, apic_phase, apic_position, apic_weight,
        apic_centre, apic_inverse, grid, period, apic, fluid, dt, apic_velocity, apic_affine,
    )


@cuda_kernel
def _apic_move(apic_phase, apic_velocity, apic_affine, apic_weight, apic_centre, period, apic, dt, apic_position):
    p = cuda.grid(1)
    if p >= apic_phase.shape[0]:
        return
    if apic_phase[p] == INACTIVE:
        return
    real = type(apic.support)
    wide = apic_position.dtype.type
    near = apic_weight[p] > real(0)
    c_x = apic_centre[0, p] if near else real(0)
    c_y = apic_centre[1, p] if near else real(0)
    c_z = apic_centre[2, p] if near else real(0)
    for a in range(3):
        turn = apic_affine[3 * a, p] * c_x + apic_affine[3 * a + 1, p] * c_y + apic_affine[3 * a + 2, p] * c_z
        if apic.literal != 0:
            c = c_x if a == 0 else (c_y if a == 1 else c_z)
            apic_position[a, p] += wide(c + dt * apic_velocity[a, p])
        else:
            apic_position[a, p] += wide(dt * (apic_velocity[a, p] - turn))
    apic_position[0, p] = into_box(apic_position[0, p], period.lower_x, period.length_x, period.inverse_x)
    apic_position[1, p] = into_box(apic_position[1, p], period.lower_y, period.length_y, period.inverse_y)
    apic_position[2, p] = into_box(apic_position[2, p], period.lower_z, period.length_z, period.inverse_z)


def apic_move(apic_phase, apic_velocity, apic_affine, apic_weight, apic_centre, period, apic, dt, apic_position):
    """See `melt.reference.apic_back.apic_move`."""
    _apic_move.launch(
        apic_phase.shape[0], apic_phase, apic_velocity, apic_affine, apic_weight, apic_centre, period, apic, dt, apic_position,
    )


@cuda_kernel
def _apic_sums(apic_phase, apic_mass, apic_state, apic_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    wide = apic_sums.dtype.type
    n = apic_phase.shape[0]
    orphans, mass, active = wide(0), wide(0), wide(0)
    for p in range(share * n // 64, (share + 1) * n // 64):
        if apic_phase[p] != INACTIVE:
            active += wide(1)
            if apic_state[p] == ORPHAN:
                orphans += wide(1)
                mass += wide(apic_mass[p])
    apic_sums[0, share], apic_sums[1, share], apic_sums[2, share] = orphans, mass, active


def apic_sums(apic_phase, apic_mass, apic_state, apic_sums):
    """See `melt.reference.apic_back.apic_sums`."""
    _apic_sums.launch(64, apic_phase, apic_mass, apic_state, apic_sums)
