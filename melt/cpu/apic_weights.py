"""CPU twin of `melt.reference.apic_weights`."""

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.cpu._apic import PAD, copy_places, moments, pad
from melt.cpu._ranges import rows_around
from melt.params import ORPHAN
from melt.physics.apic import about_centre, pseudo_inverse
from melt.physics.phases import INACTIVE
from melt.physics.ranges import ROWS, cell_at


@cpu_helper
def _store(p, s, centre, inverse, apic_weight, apic_centre, apic_inverse):
    apic_weight[p] = s
    for a in range(3):
        apic_centre[a, p] = centre[a]
    for a in range(6):
        apic_inverse[a, p] = inverse[a]


@cpu_helper
def _weigh(
    position, phase, cell_start, apic_phase, apic_position, grid, period, apic, first, stop,
    apic_weight, apic_centre, apic_inverse, apic_state,
):
    """Do the work of the stage for APIC particles first to stop - 1."""
    real = type(apic.support)
    row, last = np.empty((ROWS, 2), np.int64), np.int64(-1)
    size, end = 1024, 0
    place, value, number = np.empty((3, size), position.dtype), np.empty((1, size), apic_weight.dtype), np.empty(size, np.int32)
    for p in range(first, stop):
        s, state = real(0), 0
        centre, inverse = (s, s, s), (s, s, s, s, s, s)
        if apic_phase[p] != INACTIVE:
            x, y, z = apic_position[0, p], apic_position[1, p], apic_position[2, p]
            c_x, c_y, c_z = cell_at(x, y, z, grid)
            cell = c_x + grid.nx * (c_y + grid.ny * c_z)
            if cell != last:
                rows, total = rows_around(cell_start, grid, period, c_x, c_y, c_z, row)
                if total + PAD > size:  # a crowded cell
                    size = 2 * (total + PAD)
                    place, value = np.empty((3, size), position.dtype), np.empty((1, size), apic_weight.dtype)
                    number = np.empty(size, np.int32)
                count = copy_places(position, phase, row, rows, place, number)
                value[0, :count] = real(1)
                end, last = pad(place, value, count), cell
            s, m, D = moments(place, value, end, x, y, z, centre, period, apic)
            if s < apic.orphan:
                s, state = real(0), ORPHAN
            else:
                centre, D, again = about_centre(s, m, D)
                if again:
                    s, m, D = moments(place, value, end, x, y, z, centre, period, apic)
                    rest, D, again = about_centre(s, m, D)
                    centre = centre[0] + rest[0], centre[1] + rest[1], centre[2] + rest[2]
                inverse = pseudo_inverse(D, apic.rank)
        apic_state[p] = state
        _store(p, s, centre, inverse, apic_weight, apic_centre, apic_inverse)


@cpu_stage
def apic_weights(
    position, phase, cell_start, apic_phase, apic_position, grid, period, apic,
    apic_weight, apic_centre, apic_inverse, apic_state,
):
    """See `melt.reference.apic_weights.apic_weights`."""
    n = apic_phase.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # the inactive ones are at the end
        _weigh(
            position, phase, cell_start, apic_phase, apic_position, grid, period, apic, piece * n // 64, (piece + 1) * n // 64,
            apic_weight, apic_centre, apic_inverse, apic_state,
        )
