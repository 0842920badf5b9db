"""CPU twin of `melt.reference.apic_stress`."""

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._apic import PAD, affine_sums, pad
from melt.cpu._ranges import rows_around
from melt.physics.apic import pull, relaxed
from melt.physics.phases import INACTIVE, LIQUID
from melt.physics.ranges import ROWS, cell_at


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
def _copy_pull(
    row, rows, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain, apic, modulus, place, value,
):
    """Copy the APIC particles of the rows: 0, V_p/S_p tau_p D_p^+ c_p and minus V_p/S_p tau_p D_p^+; return how many."""
    real = type(modulus)
    slot = np.uint64(0)
    for r in range(rows):
        for p in range(np.uint64(row[r, 0]), np.uint64(row[r, 1])):
            s = apic_weight[p]
            f = -modulus * apic_mass[p] / (s * apic.rest_density) if s > real(0) else real(0)
            b = (
                apic_strain[0, p], apic_strain[1, p], apic_strain[2, p], apic_strain[3, p], apic_strain[4, p], apic_strain[5, p],
            )
            D = (
                apic_inverse[0, p], apic_inverse[1, p], apic_inverse[2, p],
                apic_inverse[3, p], apic_inverse[4, p], apic_inverse[5, p],
            )
            M = pull(b, D, f)
            x, y, z = apic_centre[0, p], apic_centre[1, p], apic_centre[2, p]
            value[0, slot] = real(0)
            for a in range(3):
                place[a, slot] = apic_position[a, p]
                value[1 + a, slot] = -(M[3 * a] * x + M[3 * a + 1] * y + M[3 * a + 2] * z)
            for a in range(9):
                value[4 + a, slot] = M[a]
            slot += np.uint64(1)
    return np.int64(slot)


@cpu_helper
def _add_force(
    position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain,
    grid, period, apic, modulus, first, stop, force,
):
    """Do the work of the stage for particles first to stop - 1."""
    row, last = np.empty((ROWS, 2), np.int64), np.int64(-1)
    size, end = 4096, 0
    place, value = np.empty((3, size), position.dtype), np.empty((13, size), force.dtype)
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
            count = _copy_pull(
                row, rows, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain, apic, modulus,
                place, value,
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
