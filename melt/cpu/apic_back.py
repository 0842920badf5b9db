"""CPU twin of `melt.reference.apic_back`."""

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._apic import PAD, copy_places, pad, velocity_sums
from melt.cpu._ranges import rows_around
from melt.params import ORPHAN
from melt.physics.period import into_box
from melt.physics.phases import INACTIVE
from melt.physics.ranges import ROWS, cell_at


@cpu_helper
def _copy_velocity(velocity, velocity_kept, number, count, apic, value):
    """Copy v_I, and v_I less the share of FLIP of v_I^kept."""
    for k in range(np.uint64(count)):
        i = np.uint64(number[k])
        for a in range(3):
            value[a, k] = value[3 + a, k] = velocity[a, i]
    if apic.flip > type(apic.flip)(0):
        for k in range(np.uint64(count)):
            i = np.uint64(number[k])
            for a in range(3):
                value[3 + a, k] -= apic.flip * velocity_kept[a, i]


@cpu_helper
def _store(p, s, mean, B, flip, apic_inverse, apic_velocity, apic_affine):
    f = type(s)(1) / s
    xx, yy, zz = f * apic_inverse[0, p], f * apic_inverse[1, p], f * apic_inverse[2, p]
    xy, xz, yz = f * apic_inverse[3, p], f * apic_inverse[4, p], f * apic_inverse[5, p]
    for a in range(3):
        apic_velocity[a, p] = f * mean[a] + flip * apic_velocity[a, p]
        b_x, b_y, b_z = B[3 * a], B[3 * a + 1], B[3 * a + 2]
        apic_affine[3 * a, p] = b_x * xx + b_y * xy + b_z * xz
        apic_affine[3 * a + 1, p] = b_x * xy + b_y * yy + b_z * yz
        apic_affine[3 * a + 2, p] = b_x * xz + b_y * yz + b_z * zz


@cpu_helper
def _back(
    position, phase, cell_start, velocity, velocity_kept, apic_phase, apic_position, apic_weight, apic_centre, apic_inverse,
    grid, period, apic, fluid, dt, first, stop, apic_velocity, apic_affine,
):
    """Do the work of the stage for APIC particles first to stop - 1."""
    real = type(apic.support)
    row, last = np.empty((ROWS, 2), np.int64), np.int64(-1)
    size, end = 1024, 0
    place, value, number = np.empty((3, size), position.dtype), np.empty((6, size), velocity.dtype), np.empty(size, np.int32)
    for p in range(first, stop):
        if apic_phase[p] == INACTIVE:
            continue
        s = apic_weight[p]
        if not s > real(0):
            apic_velocity[0, p] += dt * fluid.gravity_x
            apic_velocity[1, p] += dt * fluid.gravity_y
            apic_velocity[2, p] += dt * fluid.gravity_z
            continue
        x, y, z = apic_position[0, p], apic_position[1, p], apic_position[2, p]
        c_x, c_y, c_z = cell_at(x, y, z, grid)
        cell = c_x + grid.nx * (c_y + grid.ny * c_z)
        if cell != last:
            rows, total = rows_around(cell_start, grid, period, c_x, c_y, c_z, row)
            if total + PAD > size:  # a crowded cell
                size = 2 * (total + PAD)
                place, value = np.empty((3, size), position.dtype), np.empty((6, size), velocity.dtype)
                number = np.empty(size, np.int32)
            count = copy_places(position, phase, row, rows, place, number)
            _copy_velocity(velocity, velocity_kept, number, count, apic, value)
            end, last = pad(place, value, count), cell
        centre = apic_centre[0, p], apic_centre[1, p], apic_centre[2, p]
        mean, B = velocity_sums(place, value, end, x, y, z, centre, period, apic)
        _store(p, s, mean, B, apic.flip, apic_inverse, apic_velocity, apic_affine)


@cpu_stage
def nodes_to_apic(
    position, phase, cell_start, velocity, velocity_kept, apic_phase, apic_position, apic_weight, apic_centre, apic_inverse,
    grid, period, apic, fluid, dt, apic_velocity, apic_affine,
):
    """See `melt.reference.apic_back.nodes_to_apic`."""
    n = apic_phase.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # the inactive ones are at the end
        _back(
            position, phase, cell_start, velocity, velocity_kept, apic_phase, apic_position, apic_weight, apic_centre,
            apic_inverse, grid, period, apic, fluid, dt, piece * n // 64, (piece + 1) * n // 64, apic_velocity, apic_affine,
        )


@cpu_stage
def apic_move(apic_phase, apic_velocity, apic_affine, apic_weight, apic_centre, period, apic, dt, apic_position):
    """See `melt.reference.apic_back.apic_move`."""
    real = type(apic.support)
    wide = apic_position.dtype.type
    for p in prange(apic_phase.shape[0]):
        if apic_phase[p] == INACTIVE:
            continue
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


@cpu_stage
def apic_sums(apic_phase, apic_mass, apic_state, apic_sums):
    """See `melt.reference.apic_back.apic_sums`."""
    n = apic_phase.shape[0]
    for share in prange(64):
        orphans, mass, active = np.float64(0), np.float64(0), np.float64(0)
        for p in range(share * n // 64, (share + 1) * n // 64):
            if apic_phase[p] != INACTIVE:
                active += np.float64(1)
                if apic_state[p] == ORPHAN:
                    orphans += np.float64(1)
                    mass += np.float64(apic_mass[p])
        apic_sums[0, share], apic_sums[1, share], apic_sums[2, share] = orphans, mass, active
