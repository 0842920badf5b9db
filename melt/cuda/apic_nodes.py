"""CUDA twin of `melt.reference.apic_nodes`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.params import MASSLESS
from melt.physics.period import wrap
from melt.physics.phases import LIQUID
from melt.physics.ranges import ROWS, cell_at, row_cells
from melt.physics.smoothing import W


@cuda_kernel
def _apic_to_nodes(
    position, phase, apic_start, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre,
    grid, period, apic, mass, volume, velocity, node_state,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    node_state[i] = 0
    if phase[i] != LIQUID:
        return
    real = type(apic.support)
    zero = real(0)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    c_x, c_y, c_z = cell_at(x_i, y_i, z_i, grid)
    m = u = v = w = zero
    for k in range(ROWS):
        first, stop = row_cells(k, c_x, c_y, c_z, grid, period)
        for p in range(apic_start[first], apic_start[stop]):
            x = real(wrap(x_i - apic_position[0, p], period.length_x, period.inverse_x))
            y = real(wrap(y_i - apic_position[1, p], period.length_y, period.inverse_y))
            z = real(wrap(z_i - apic_position[2, p], period.length_z, period.inverse_z))
            share = W(math.sqrt(x * x + y * y + z * z), apic)
            if not share > zero or not apic_weight[p] > zero:  # few of the candidates are near enough
                continue
            share *= apic_mass[p] / apic_weight[p]
            f = share if apic.affine != 0 else zero
            x, y, z = f * (x - apic_centre[0, p]), f * (y - apic_centre[1, p]), f * (z - apic_centre[2, p])
            m += share
            u += share * apic_velocity[0, p] + apic_affine[0, p] * x + apic_affine[1, p] * y + apic_affine[2, p] * z
            v += share * apic_velocity[1, p] + apic_affine[3, p] * x + apic_affine[4, p] * y + apic_affine[5, p] * z
            w += share * apic_velocity[2, p] + apic_affine[6, p] * x + apic_affine[7, p] * y + apic_affine[8, p] * z
    if m < apic.massless:
        node_state[i] = MASSLESS
        mass[i], volume[i] = zero, zero
    else:
        mass[i], volume[i] = m, min(m / apic.rest_density, apic.most)
        velocity[0, i], velocity[1, i], velocity[2, i] = u / m, v / m, w / m


def apic_to_nodes(
    position, phase, apic_start, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre,
    grid, period, apic, mass, volume, velocity, node_state,
):
    """See `melt.reference.apic_nodes.apic_to_nodes`."""
    _apic_to_nodes.launch(
        phase.shape[0], position, phase, apic_start, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight,
        apic_centre, grid, period, apic, mass, volume, velocity, node_state,
    )


@cuda_kernel
def _massless_velocity(position, phase, node_state, volume, neighbour_count, neighbour_index, smoothing, period, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if node_state[i] != MASSLESS:
        return
    real = type(smoothing.support)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    s = u = v = w = real(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        if phase[j] != LIQUID or node_state[j] != 0:
            continue
        x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
        y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
        z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
        share = volume[j] * W(math.sqrt(x * x + y * y + z * z), smoothing)
        s += share
        u, v, w = u + share * velocity[0, j], v + share * velocity[1, j], w + share * velocity[2, j]
    if s > real(0):
        velocity[0, i], velocity[1, i], velocity[2, i] = u / s, v / s, w / s


def massless_velocity(position, phase, node_state, volume, neighbour_count, neighbour_index, smoothing, period, velocity):
    """See `melt.reference.apic_nodes.massless_velocity`."""
    _massless_velocity.launch(
        phase.shape[0], position, phase, node_state, volume, neighbour_count, neighbour_index, smoothing, period, velocity,
    )
