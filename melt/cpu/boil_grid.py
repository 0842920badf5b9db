"""CPU twin of `melt.reference.boil_grid`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.boiling import approach, gain, heated, sampled
from melt.physics.phases import LIQUID

PIECES = 64


@cpu_stage
def voxel_heat(voxel_temperature, tank, dt, voxel_temperature_next):
    """See `melt.reference.boil_grid.voxel_heat`."""
    real = voxel_temperature.dtype.type
    nx, ny, nz = int(tank.nx), int(tank.ny), int(tank.nz)
    a = dt * tank.number
    for row in prange(ny * nz):
        iz = np.int64(row) // ny
        iy = np.int64(row) - iz * ny
        for ix in range(nx):
            c = ix + nx * (iy + ny * iz)
            T = voxel_temperature[c]
            x = voxel_temperature[c - 1] - T if ix > 0 else real(0)
            x += voxel_temperature[c + 1] - T if ix < nx - 1 else real(0)
            y = voxel_temperature[c - nx] - T if iy > 0 else real(0)
            y += voxel_temperature[c + nx] - T if iy < ny - 1 else real(0)
            z = voxel_temperature[c - nx * ny] - T if iz > 0 else real(0)
            z += voxel_temperature[c + nx * ny] - T if iz < nz - 1 else real(0)
            voxel_temperature_next[c] = T + a * (x + y + z)  # (9)


@cpu_stage
def voxel_heater(tank, boiling, target, share, voxel_temperature, heater_heat):
    """See `melt.reference.boil_grid.voxel_heater`."""
    real = voxel_temperature.dtype.type
    nx, ny = int(tank.nx), int(tank.ny)
    edge = real(1) / tank.inverse_cell
    for piece in prange(PIECES):
        heat = np.float64(0)
        p = np.int64(piece)
        for c in range(nx * ny * p // PIECES, nx * ny * (p + 1) // PIECES):
            iy = c // nx
            x = tank.origin_x + edge * (real(c - nx * iy) + real(0.5))
            y = tank.origin_y + edge * (real(iy) + real(0.5))
            if heated(x, y, boiling):
                before = voxel_temperature[c]
                after = approach(before, target, share)
                voxel_temperature[c] = after
                heat += np.float64(tank.capacity) * gain(np.float64(before), np.float64(after))
        heater_heat[piece] = heat


@cpu_stage
def voxel_sample(voxel_temperature, position, phase, tank, boiling, temperature):
    """See `melt.reference.boil_grid.voxel_sample`."""
    for i in prange(phase.shape[0]):
        if phase[i] == LIQUID:
            T = sampled(position[0, i], position[1, i], position[2, i], voxel_temperature, tank)
            temperature[i] = min(T, boiling.boiling_point)
