"""CUDA twin of `melt.reference.guard`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.contact import reduced_mass
from melt.physics.phases import LIQUID, SOLID, WALL


@cuda_kernel
def _guard_offenders(position, phase, neighbour_count, neighbour_index, guard, offenders):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(guard.distance)
    d2 = guard.distance * guard.distance
    found = 0
    if phase[i] == LIQUID or phase[i] == SOLID:
        # partners of a liquid are 1 and 2 (solid, wall), of a solid 0 (liquid)
        first, last = (SOLID, WALL) if phase[i] == LIQUID else (LIQUID, LIQUID)
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        for k in range(neighbour_count[i]):
            j = neighbour_index[i, k]
            if phase[j] < first or phase[j] > last:
                continue
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            found += x * x + y * y + z * z < d2
    offenders[i] = found


def guard_offenders(position, phase, neighbour_count, neighbour_index, guard, offenders):
    """See `melt.reference.guard.guard_offenders`."""
    _guard_offenders.launch(
        phase.shape[0], position, phase, neighbour_count, neighbour_index, guard, offenders,
    )


@cuda_kernel
def _guard_correction(
    position, velocity, phase, mass, offenders, neighbour_count, neighbour_index, guard,
    position_next, velocity_next,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(guard.distance)
    wide = position.dtype.type
    d = guard.distance
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    dx = dy = dz = wide(0)
    du = dv = dw = wide(0)
    first, last = (SOLID, WALL) if phase[i] == LIQUID else (LIQUID, LIQUID)
    for k in range(neighbour_count[i] if offenders[i] > 0 else 0):
        j = neighbour_index[i, k]
        if phase[j] < first or phase[j] > last:
            continue
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        r2 = x * x + y * y + z * z
        if r2 >= d * d or r2 < real(1e-18) * d * d:
            continue
        r = math.sqrt(r2)
        x, y, z = x / r, y / r, z / r
        wall = phase[j] == WALL
        most = offenders[i] if wall else max(offenders[i], offenders[j])
        share = reduced_mass(mass[i], mass[j], wall) / (mass[i] * real(most))
        push = share * (d - r)
        v_n = (u_i - velocity[0, j]) * x + (v_i - velocity[1, j]) * y + (w_i - velocity[2, j]) * z
        stop = share * min(v_n, real(0))
        dx += push * x
        dy += push * y
        dz += push * z
        du += stop * x
        dv += stop * y
        dw += stop * z
    position_next[0, i] = x_i + dx
    position_next[1, i] = y_i + dy
    position_next[2, i] = z_i + dz
    velocity_next[0, i] = u_i - real(du)
    velocity_next[1, i] = v_i - real(dv)
    velocity_next[2, i] = w_i - real(dw)


def guard_correction(
    position, velocity, phase, mass, offenders, neighbour_count, neighbour_index, guard,
    position_next, velocity_next,
):
    """See `melt.reference.guard.guard_correction`."""
    _guard_correction.launch(
        phase.shape[0], position, velocity, phase, mass, offenders, neighbour_count, neighbour_index, guard,
        position_next, velocity_next,
    )
