"""CUDA twin of `melt.reference.apic_stress`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.apic import pull, relaxed
from melt.physics.period import wrap
from melt.physics.phases import INACTIVE, LIQUID
from melt.physics.ranges import ROWS, cell_at, row_cells
from melt.physics.smoothing import W


@cuda_kernel
def _apic_strain(apic_phase, apic_affine, elastic, dt, apic_strain):
    p = cuda.grid(1)
    if p >= apic_phase.shape[0]:
        return
    if apic_phase[p] == INACTIVE:
        return
    C = (
        apic_affine[0, p], apic_affine[1, p], apic_affine[2, p], apic_affine[3, p], apic_affine[4, p],
        apic_affine[5, p], apic_affine[6, p], apic_affine[7, p], apic_affine[8, p],
    )
    b = (apic_strain[0, p], apic_strain[1, p], apic_strain[2, p], apic_strain[3, p], apic_strain[4, p], apic_strain[5, p])
    b = relaxed(C, b, dt, elastic)
    for a in range(6):
        apic_strain[a, p] = b[a]


def apic_strain(apic_phase, apic_affine, elastic, dt, apic_strain):
    """See `melt.reference.apic_stress.apic_strain`."""
    _apic_strain.launch(apic_phase.shape[0], apic_phase, apic_affine, elastic, dt, apic_strain)


@cuda_kernel
def _elastic_force(
    position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain,
    grid, period, apic, elastic, dt, force,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] != LIQUID:
        return
    real = type(dt)
    modulus = elastic.modulus / (real(1) + dt / elastic.relaxation)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    c_x, c_y, c_z = cell_at(x_i, y_i, z_i, grid)
    u = v = w = real(0)
    for k in range(ROWS):
        first, stop = row_cells(k, c_x, c_y, c_z, grid, period)
        for p in range(apic_start[first], apic_start[stop]):
            x = real(wrap(x_i - apic_position[0, p], period.length_x, period.inverse_x))
            y = real(wrap(y_i - apic_position[1, p], period.length_y, period.inverse_y))
            z = real(wrap(z_i - apic_position[2, p], period.length_z, period.inverse_z))
            share = W(math.sqrt(x * x + y * y + z * z), apic)
            if not share > real(0) or not apic_weight[p] > real(0):  # few of the candidates are near enough
                continue
            x, y, z = x - apic_centre[0, p], y - apic_centre[1, p], z - apic_centre[2, p]
            b = (
                apic_strain[0, p], apic_strain[1, p], apic_strain[2, p], apic_strain[3, p], apic_strain[4, p], apic_strain[5, p],
            )
            D = (
                apic_inverse[0, p], apic_inverse[1, p], apic_inverse[2, p],
                apic_inverse[3, p], apic_inverse[4, p], apic_inverse[5, p],
            )
            M = pull(b, D, modulus * share * apic_mass[p] / (apic_weight[p] * apic.rest_density))
            u -= M[0] * x + M[1] * y + M[2] * z
            v -= M[3] * x + M[4] * y + M[5] * z
            w -= M[6] * x + M[7] * y + M[8] * z
    force[0, i] += u
    force[1, i] += v
    force[2, i] += w


def elastic_force(
    position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain,
    grid, period, apic, elastic, dt, force,
):
    """See `melt.reference.apic_stress.elastic_force`."""
    _elastic_force.launch(
        phase.shape[0], position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse,
        apic_strain, grid, period, apic, elastic, dt, force,
    )
