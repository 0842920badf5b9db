"""CUDA twin of `melt.reference.apic_weights`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.params import ORPHAN
from melt.physics.apic import about_centre, pseudo_inverse
from melt.physics.period import wrap
from melt.physics.phases import INACTIVE, LIQUID
from melt.physics.ranges import ROWS, cell_at, row_cells
from melt.physics.smoothing import W


@cuda_kernel
def _apic_weights(
    position, phase, cell_start, apic_phase, apic_position, grid, period, apic, apic_weight, apic_centre, apic_inverse, apic_state,
):
    p = cuda.grid(1)
    if p >= apic_phase.shape[0]:
        return
    real = type(apic.support)
    x_p, y_p, z_p = apic_position[0, p], apic_position[1, p], apic_position[2, p]
    c_x, c_y, c_z = cell_at(x_p, y_p, z_p, grid)
    s = a = b = c = real(0)
    inverse = s, s, s, s, s, s
    apic_state[p] = 0
    rows = ROWS if apic_phase[p] != INACTIVE else 0
    for again in range(2):
        s = mx = my = mz = xx = yy = zz = xy = xz = yz = real(0)
        for k in range(rows):
            first, stop = row_cells(k, c_x, c_y, c_z, grid, period)
            for i in range(cell_start[first], cell_start[stop]):
                if phase[i] != LIQUID:
                    continue
                x = real(wrap(position[0, i] - x_p, period.length_x, period.inverse_x))
                y = real(wrap(position[1, i] - y_p, period.length_y, period.inverse_y))
                z = real(wrap(position[2, i] - z_p, period.length_z, period.inverse_z))
                w = W(math.sqrt(x * x + y * y + z * z), apic)
                x, y, z = x - a, y - b, z - c
                s += w
                mx, my, mz = mx + w * x, my + w * y, mz + w * z
                xx, yy, zz = xx + w * x * x, yy + w * y * y, zz + w * z * z
                xy, xz, yz = xy + w * x * y, xz + w * x * z, yz + w * y * z
        if s < apic.orphan:
            s = real(0)
            apic_state[p] = ORPHAN if rows > 0 else 0
            break
        rest, D, poor = about_centre(s, (mx, my, mz), (xx, yy, zz, xy, xz, yz))
        a, b, c = a + rest[0], b + rest[1], c + rest[2]
        if not poor or again == 1:
            inverse = pseudo_inverse(D, apic.rank)
            break
    apic_weight[p] = s
    apic_centre[0, p], apic_centre[1, p], apic_centre[2, p] = a, b, c
    for k in range(6):
        apic_inverse[k, p] = inverse[k]


def apic_weights(
    position, phase, cell_start, apic_phase, apic_position, grid, period, apic,
    apic_weight, apic_centre, apic_inverse, apic_state,
):
    """See `melt.reference.apic_weights.apic_weights`."""
    _apic_weights.launch(
        apic_phase.shape[0], position, phase, cell_start, apic_phase, apic_position, grid, period, apic,
        apic_weight, apic_centre, apic_inverse, apic_state,
    )
