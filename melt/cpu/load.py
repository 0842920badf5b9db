"""CPU twin of `melt.reference.load`. Sums in float64: 64 shares of particles, added in order."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.period import wrap
from melt.physics.poisson import wall_rise


@cpu_stage
def pressure_load(
    driver, position, velocity, velocity_kept, volume, mobility, solver_pressure, neighbour_count, neighbour_index, pair_gradient,
    poisson, fluid, period, mirror, dt, body_load,
):
    """See `melt.reference.load.pressure_load`."""
    real = volume.dtype.type
    wide = np.float64
    per_dt = real(1) / dt
    n = volume.shape[0]
    for share in prange(64):
        for body in range(body_load.shape[1]):
            body_load[0, body, share] = body_load[1, body, share] = body_load[2, body, share] = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            if not mobility[i] > real(0):
                continue
            p, V = solver_pressure[i], volume[i]
            for k in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, k])
                body = driver[j]
                if body < 0:
                    continue
                rise = wall_rise(
                    real(wrap(position[0, j] - position[0, i], period.length_x, period.inverse_x)),
                    real(wrap(position[1, j] - position[1, i], period.length_y, period.inverse_y)),
                    real(wrap(position[2, j] - position[2, i], period.length_z, period.inverse_z)),
                    fluid.gravity_x - per_dt * (velocity[0, j] - velocity_kept[0, j]),
                    fluid.gravity_y - per_dt * (velocity[1, j] - velocity_kept[1, j]),
                    fluid.gravity_z - per_dt * (velocity[2, j] - velocity_kept[2, j]),
                    p, poisson,
                )
                c = V * (p + mirror * (p + rise))
                body_load[0, body, share] += wide(c * pair_gradient[0, i, k])
                body_load[1, body, share] += wide(c * pair_gradient[1, i, k])
                body_load[2, body, share] += wide(c * pair_gradient[2, i, k])


@cpu_stage
def shear_load(driver, velocity, neighbour_count, neighbour_index, pair_shear, body_load):
    """See `melt.reference.load.shear_load`."""
    wide = np.float64
    n = driver.shape[0]
    for share in prange(64):
        for body in range(body_load.shape[1]):
            body_load[0, body, share] = body_load[1, body, share] = body_load[2, body, share] = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            for k in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, k])
                body = driver[j]
                if body < 0:
                    continue
                a, b, c = pair_shear[0, i, k], pair_shear[1, i, k], pair_shear[2, i, k]
                along = (
                    a * (velocity[0, i] - velocity[0, j]) + b * (velocity[1, i] - velocity[1, j]) + c * (velocity[2, i] - velocity[2, j])
                )
                body_load[0, body, share] += wide(a * along)
                body_load[1, body, share] += wide(b * along)
                body_load[2, body, share] += wide(c * along)
