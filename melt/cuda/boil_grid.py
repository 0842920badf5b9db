"""CUDA twin of `melt.reference.boil_grid`."""

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.physics.boiling import approach, gain, heated, sampled
from melt.physics.phases import LIQUID


@cuda_kernel
def _voxel_heat(voxel_temperature, tank, dt, voxel_temperature_next):
    c = cuda.grid(1)
    real = voxel_temperature.dtype.type
    nx, ny, nz = int(tank.nx), int(tank.ny), int(tank.nz)
    if c >= nx * ny * nz:
        return
    iz = c // (nx * ny)
    iy = c // nx - ny * iz
    ix = c - nx * (iy + ny * iz)
    a = dt * tank.number
    T = voxel_temperature[c]
    x = voxel_temperature[c - 1] - T if ix > 0 else real(0)
    x += voxel_temperature[c + 1] - T if ix < nx - 1 else real(0)
    y = voxel_temperature[c - nx] - T if iy > 0 else real(0)
    y += voxel_temperature[c + nx] - T if iy < ny - 1 else real(0)
    z = voxel_temperature[c - nx * ny] - T if iz > 0 else real(0)
    z += voxel_temperature[c + nx * ny] - T if iz < nz - 1 else real(0)
    voxel_temperature_next[c] = T + a * (x + y + z)  # (9)


def voxel_heat(voxel_temperature, tank, dt, voxel_temperature_next):
    """See `melt.reference.boil_grid.voxel_heat`."""
    _voxel_heat.launch(voxel_temperature.shape[0], voxel_temperature, tank, dt, voxel_temperature_next)


@cuda_kernel
def _voxel_heater(tank, boiling, target, share, voxel_temperature, heater_heat):
    p = cuda.grid(1)
    pieces = heater_heat.shape[0]
    if p >= pieces:
        return
    real = voxel_temperature.dtype.type
    nx, ny = int(tank.nx), int(tank.ny)
    edge = real(1) / tank.inverse_cell
    heat = np.float64(0)
    for c in range(nx * ny * p // pieces, nx * ny * (p + 1) // pieces):
        iy = c // nx
        x = tank.origin_x + edge * (real(c - nx * iy) + real(0.5))
        y = tank.origin_y + edge * (real(iy) + real(0.5))
        if heated(x, y, boiling):
            before = voxel_temperature[c]
            after = approach(before, target, share)
            voxel_temperature[c] = after
            heat += np.float64(tank.capacity) * gain(np.float64(before), np.float64(after))
    heater_heat[p] = heat


def voxel_heater(tank, boiling, target, share, voxel_temperature, heater_heat):
    """See `melt.reference.boil_grid.voxel_heater`."""
    _voxel_heater.launch(heater_heat.shape[0], tank, boiling, target, share, voxel_temperature, heater_heat)


@cuda_kernel
def _voxel_sample(voxel_temperature, position, phase, tank, boiling, temperature):
    i = cuda.grid(1)
    if i < phase.shape[0] and phase[i] == LIQUID:
        T = sampled(position[0, i], position[1, i], position[2, i], voxel_temperature, tank)
        temperature[i] = min(T, boiling.boiling_point)


def voxel_sample(voxel_temperature, position, phase, tank, boiling, temperature):
    """See `melt.reference.boil_grid.voxel_sample`."""
    _voxel_sample.launch(phase.shape[0], voxel_temperature, position, phase, tank, boiling, temperature)
