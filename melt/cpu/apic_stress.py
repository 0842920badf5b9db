"""CPU twin of `melt.reference.apic_stress`."""

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._apic import PAD, affine_sums, less_turn, pad
from melt.cpu._ranges import rows_around
from melt.physics.apic import relaxed
from melt.physics.phases import INACTIVE, LIQUID
from melt.physics.ranges import ROWS, cell_at

#: Where the elements of a row of a symmetric tensor are stored.
ROW = ((0, 3, 4), (3, 1, 5), (4, 5, 2))


@cpu_stage
def apic_strain(apic_phase, apic_affine, elastic, dt, apic_strain):
    """See `melt.reference.apic_stress.apic_strain`."""
    n = apic_phase.shape[0]
    for share in prange(64):  # fixed shares: a vectorised division and that of a loop's rest may round apart
        for p in range(share * n // 64, (share + 1) * n // 64):
            if apic_phase[p] == INACTIVE:
                continue
            C = (
                apic_affine[0, p], apic_affine[1, p], apic_affine[2, p], apic_affine[3, p], apic_affine[4, p],
                apic_affine[5, p], apic_affine[6, p], apic_affine[7, p], apic_affine[8, p],
            )
            b = (
                apic_strain[0, p], apic_strain[1, p], apic_strain[2, p], apic_strain[3, p], apic_strain[4, p], apic_strain[5, p],
            )
            b = relaxed(C, b, dt, elastic)
            for a in range(6):
                apic_strain[a, p] = b[a]


@cpu_helper
def _pull_row(b, D, a, c, first, target, slot, count, factor):
    """Write factor times element (a, c) of (b - I) D for the APIC particles of a row."""
    real = target.dtype.type
    first, slot = np.uint64(first), np.uint64(slot)
    b_x, b_y, b_z = b[ROW[a][0]], b[ROW[a][1]], b[ROW[a][2]]
    D_x, D_y, D_z = D[ROW[c][0]], D[ROW[c][1]], D[ROW[c][2]]
    one_x, one_y, one_z = real(a == 0), real(a == 1), real(a == 2)
    for k in range(np.uint64(count)):
        p = first + k
        target[slot + k] = factor[slot + k] * ((b_x[p] - one_x) * D_x[p] + (b_y[p] - one_y) * D_y[p] + (b_z[p] - one_z) * D_z[p])


@cpu_helper
def _copy_pull(
    row, rows, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain, apic, modulus, place, value, factor,
):
    """Copy the APIC particles of the rows: 0, V_p/S_p tau_p D_p^+ c_p and minus V_p/S_p tau_p D_p^+; return how many."""
    real = type(modulus)
    scale, slot = -modulus / apic.rest_density, 0
    for r in range(rows):
        first, count = row[r, 0], row[r, 1] - row[r, 0]
        for k in range(np.uint64(count)):
            p, q = np.uint64(first) + k, np.uint64(slot) + k
            s = apic_weight[p]
            factor[q] = scale * apic_mass[p] / s if s > real(0) else real(0)
            value[0, q] = real(0)
        for a in range(3):
            for k in range(np.uint64(count)):
                place[a, np.uint64(slot) + k] = apic_position[a, np.uint64(first) + k]
                value[1 + a, np.uint64(slot) + k] = real(0)
            for c in range(3):
                _pull_row(apic_strain, apic_inverse, a, c, first, value[4 + 3 * a + c], slot, count, factor)
            less_turn(value[4 + 3 * a], value[5 + 3 * a], value[6 + 3 * a], apic_centre, first, value[1 + a], slot, count)
        slot += count
    return slot


@cpu_helper
def _add_force(
    position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain,
    grid, period, apic, modulus, first, stop, force,
):
    """Do the work of the stage for particles first to stop - 1."""
    row, last = np.empty((ROWS, 2), np.int64), np.int64(-1)
    size, end = 4096, 0
    place, value, factor = np.empty((3, size), position.dtype), np.empty((13, size), force.dtype), np.empty(size, force.dtype)
    for i in range(first, stop):
        if phase[i] != LIQUID:
            continue
        x, y, z = position[0, i], position[1, i], position[2, i]
        c_x, c_y, c_z = cell_at(x, y, z, grid)
        cell = c_x + grid.nx * (c_y + grid.ny * c_z)
        if cell != last:
            rows, total = rows_around(apic_start, grid, period, c_x, c_y, c_z, row)
            if total + PAD > size:  # a crowded cell
                size = 2 * (total + PAD)
                place, value = np.empty((3, size), position.dtype), np.empty((13, size), force.dtype)
                factor = np.empty(size, force.dtype)
            count = _copy_pull(
                row, rows, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain, apic, modulus,
                place, value, factor,
            )
            end, last = pad(place, value, count), cell
        _, u, v, w = affine_sums(place, value, end, x, y, z, period, apic)
        force[0, i] += u
        force[1, i] += v
        force[2, i] += w


@cpu_stage
def elastic_force(
    position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain,
    grid, period, apic, elastic, dt, force,
):
    """See `melt.reference.apic_stress.elastic_force`."""
    real = type(dt)
    n = phase.shape[0]
    modulus = elastic.modulus / (real(1) + dt / elastic.relaxation)
    for chunk in prange(64):
        piece = (chunk * 37) % 64
        _add_force(
            position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain,
            grid, period, apic, modulus, piece * n // 64, (piece + 1) * n // 64, force,
        )
