r"""Temperature on a grid, the traditional model that the paper compares against. Boiling eq (9), spec 2.3.

.. math:: T_c \leftarrow T_c + dt \frac{\alpha}{d^2} \sum_{faces} (T_{next\,to\,c} - T_c)

Cells of edge d, x fastest; nothing passes the outer faces but at the heater.
"""

import numpy as np

from melt.reference._shares import shares


def _box(values, tank):
    """Return cell values as an array (nz, ny, nx)."""
    return values.reshape(int(tank.nz), int(tank.ny), int(tank.nx))


def voxel_heat(voxel_temperature, tank, dt, voxel_temperature_next):
    """Write cell temperatures after an explicit step; it stays within their range up to dt alpha/d^2 = 1/6.

    Reads: voxel_temperature (cells,) [degC]. Writes: voxel_temperature_next (cells,) [degC].
    """
    T = _box(voxel_temperature.astype(np.float64), tank)
    total = np.zeros_like(T)
    for axis in range(3):
        flow = np.diff(T, axis=axis)  # across inner faces
        below = [slice(None)] * 3
        above = [slice(None)] * 3
        below[axis], above[axis] = slice(None, -1), slice(1, None)
        total[tuple(below)] += flow
        total[tuple(above)] -= flow
    voxel_temperature_next[:] = (T + float(dt) * float(tank.number) * total).ravel()  # (9)


def voxel_heater(tank, boiling, target, share, voxel_temperature, heater_heat):
    """Heat the lowest cells whose centres are over the heated part of the floor: T += share (target - T).

    Writes: voxel_temperature (cells,) [degC], heater_heat (64,) [J]: what came in, from the temperatures as
        they are stored, in 64 pieces of the lowest layer.
    """
    nx, ny = int(tank.nx), int(tank.ny)
    x = float(tank.origin_x) + (np.arange(nx) + 0.5) / float(tank.inverse_cell)
    y = float(tank.origin_y) + (np.arange(ny) + 0.5) / float(tank.inverse_cell)
    over = (y >= boiling.heater_lower_y) & (y <= boiling.heater_upper_y)
    over = (over[:, None] & (x >= boiling.heater_lower_x) & (x <= boiling.heater_upper_x)).ravel()
    layer = voxel_temperature[: nx * ny]
    before = layer.astype(np.float64)
    after = before + float(share) * (float(target) - before)
    layer[over] = (after if share < 1 else np.full_like(after, target))[over]
    heat = float(tank.capacity) * (layer.astype(np.float64) - before)
    heater_heat[:] = [piece.sum() for piece in shares(heat)]


def voxel_sample(voxel_temperature, position, phase, tank, boiling, temperature):
    """Give liquid the temperature of the grid: linear between cell centres, constant beyond the outermost ones.

    At most the boiling point: there is no latent store in this model.

    Reads: voxel_temperature (cells,) [degC], position (3, n) [m], phase (n,). Writes: temperature (n,) [degC].
    """
    T = _box(voxel_temperature.astype(np.float64), tank)
    on = np.flatnonzero(phase == 0)
    origin = np.array([[tank.origin_x], [tank.origin_y], [tank.origin_z]], np.float64)
    most = np.array([[tank.nx - 1], [tank.ny - 1], [tank.nz - 1]])
    t = (position[:, on].astype(np.float64) - origin) * float(tank.inverse_cell) - 0.5
    t = np.clip(np.where(np.isnan(t), 0, t), 0, most)
    k = np.minimum(t.astype(int), np.maximum(most - 1, 0))
    part, other = t - k, np.minimum(k + 1, most)
    total = np.zeros(len(on))
    for corner in range(8):
        upper = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])[:, None] == 1
        x, y, z = np.where(upper, other, k)
        total += np.where(upper, part, 1 - part).prod(axis=0) * T[z, y, x]
    temperature[on] = np.minimum(total, float(boiling.boiling_point))
