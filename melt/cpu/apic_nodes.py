"""CPU twin of `melt.reference.apic_nodes`."""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._apic import PAD, affine_sums, less_turn, pad
from melt.cpu._ranges import rows_around
from melt.params import MASSLESS
from melt.physics.period import wrap
from melt.physics.phases import LIQUID
from melt.physics.ranges import ROWS, cell_at
from melt.physics.smoothing import W


@cpu_helper
def _copy(source, first, target, slot, count, factor):
    """Copy one array of the APIC particles of a row, each times its factor."""
    first, slot = np.uint64(first), np.uint64(slot)
    for k in range(np.uint64(count)):
        target[slot + k] = factor[slot + k] * source[first + k]


@cpu_helper
def _copy_momentum(
    row, rows, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre, apic, place, value, turn,
):
    """Copy the APIC particles of the rows: m_p/S_p times 1, v_p - C_p c_p and C_p; return how many.

    Array after array, so that the copies are vectors: particle after particle they take longer than the sums.
    """
    real = type(apic.support)
    share = value[0]
    slot = 0
    for r in range(rows):
        first, count = row[r, 0], row[r, 1] - row[r, 0]
        for k in range(np.uint64(count)):
            p, q = np.uint64(first) + k, np.uint64(slot) + k
            s = apic_weight[p]
            share[q] = apic_mass[p] / s if s > real(0) else real(0)
            turn[q] = share[q] if apic.affine != 0 else real(0)
        for a in range(3):
            for k in range(np.uint64(count)):
                place[a, np.uint64(slot) + k] = apic_position[a, np.uint64(first) + k]
            _copy(apic_velocity[a], first, value[1 + a], slot, count, share)
            for b in range(3):
                _copy(apic_affine[3 * a + b], first, value[4 + 3 * a + b], slot, count, turn)
            less_turn(value[4 + 3 * a], value[5 + 3 * a], value[6 + 3 * a], apic_centre, first, value[1 + a], slot, count)
        slot += count
    return slot


@cpu_helper
def _gather(
    position, phase, apic_start, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre,
    grid, period, apic, first, stop, mass, volume, velocity, node_state,
):
    """Do the work of the stage for particles first to stop - 1."""
    real = type(apic.support)
    row, last = np.empty((ROWS, 2), np.int64), np.int64(-1)
    size, end = 4096, 0
    place, value, turn = np.empty((3, size), position.dtype), np.empty((13, size), mass.dtype), np.empty(size, mass.dtype)
    for i in range(first, stop):
        node_state[i] = 0
        if phase[i] != LIQUID:
            continue
        x, y, z = position[0, i], position[1, i], position[2, i]
        c_x, c_y, c_z = cell_at(x, y, z, grid)
        cell = c_x + grid.nx * (c_y + grid.ny * c_z)
        if cell != last:
            rows, total = rows_around(apic_start, grid, period, c_x, c_y, c_z, row)
            if total + PAD > size:  # a crowded cell
                size = 2 * (total + PAD)
                place, value = np.empty((3, size), position.dtype), np.empty((13, size), mass.dtype)
                turn = np.empty(size, mass.dtype)
            count = _copy_momentum(
                row, rows, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre, apic, place, value, turn,
            )
            end, last = pad(place, value, count), cell
        m, u, v, w = affine_sums(place, value, end, x, y, z, period, apic)
        if m < apic.massless:
            node_state[i] = MASSLESS
            mass[i], volume[i] = real(0), real(0)
        else:
            mass[i], volume[i] = m, min(m / apic.rest_density, apic.most)
            velocity[0, i], velocity[1, i], velocity[2, i] = u / m, v / m, w / m


@cpu_stage
def apic_to_nodes(
    position, phase, apic_start, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre,
    grid, period, apic, mass, volume, velocity, node_state,
):
    """See `melt.reference.apic_nodes.apic_to_nodes`."""
    n = phase.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64
        _gather(
            position, phase, apic_start, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre,
            grid, period, apic, piece * n // 64, (piece + 1) * n // 64, mass, volume, velocity, node_state,
        )


@cpu_stage
def massless_velocity(position, phase, node_state, volume, neighbour_count, neighbour_index, smoothing, period, velocity):
    """See `melt.reference.apic_nodes.massless_velocity`."""
    real = type(smoothing.support)
    for i in prange(phase.shape[0]):
        if node_state[i] != MASSLESS:
            continue
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        s = u = v = w = real(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
            y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
            z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
            counts = phase[j] == LIQUID and node_state[j] == 0 and volume[j] > real(0)
            share = volume[j] * W(math.sqrt(x * x + y * y + z * z), smoothing) if counts else real(0)
            s += share
            u, v, w = u + share * velocity[0, j], v + share * velocity[1, j], w + share * velocity[2, j]
        if s > real(0):
            velocity[0, i], velocity[1, i], velocity[2, i] = u / s, v / s, w / s
