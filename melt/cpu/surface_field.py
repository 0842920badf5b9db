"""CPU twin of `melt.reference.surface_field`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.reconstruction import (
    eigenvalue_correction,
    field_value,
    largest_eigenvalue,
    reconstruction_weight,
    weight_slope,
)
from melt.physics.search import axis_cell


@cpu_stage
def surface_field(
    position, temperature, cell_start, surface_node, grid, reconstruction,
    surface_distance, surface_temperature,
):
    """See `melt.reference.surface_field.surface_field`."""
    real = type(reconstruction.reach)
    R = reconstruction.reach
    zero = real(0)
    for i in prange(surface_node.shape[1]):
        x_i, y_i, z_i = surface_node[0, i], surface_node[1, i], surface_node[2, i]
        c_x = axis_cell(x_i, grid.origin_x, grid.inverse_cell, grid.nx)
        c_y = axis_cell(y_i, grid.origin_y, grid.inverse_cell, grid.ny)
        c_z = axis_cell(z_i, grid.origin_z, grid.inverse_cell, grid.nz)
        first_x, last_x = max(c_x - 1, 0), min(c_x + 1, grid.nx - 1)
        W, T = zero, zero
        m_x, m_y, m_z = zero, zero, zero  # sum w d
        g_x, g_y, g_z = zero, zero, zero  # sum g d
        xx, yy, zz, xy, xz, yz = zero, zero, zero, zero, zero, zero  # sum g d d
        for z_cell in range(max(c_z - 1, 0), min(c_z + 2, grid.nz)):
            for y_cell in range(max(c_y - 1, 0), min(c_y + 2, grid.ny)):
                row = grid.nx * (y_cell + grid.ny * z_cell)
                for k in range(np.uint64(cell_start[row + first_x]), np.uint64(cell_start[row + last_x + 1])):
                    x = real(position[0, k] - x_i)
                    y = real(position[1, k] - y_i)
                    z = real(position[2, k] - z_i)
                    r2 = x * x + y * y + z * z
                    w = reconstruction_weight(r2, R)
                    W += w
                    m_x += w * x
                    m_y += w * y
                    m_z += w * z
                    if reconstruction.temperature != 0:
                        T += w * temperature[k]
                    if reconstruction.correct != 0:
                        g = weight_slope(r2, R)
                        g_x += g * x
                        g_y += g * y
                        g_z += g * z
                        xx += g * x * x
                        yy += g * y * y
                        zz += g * z * z
                        xy += g * x * y
                        xz += g * x * z
                        yz += g * y * z
        one_W = real(1) / W if W > zero else zero
        m_x, m_y, m_z = m_x * one_W, m_y * one_W, m_z * one_W
        f = real(1)
        if reconstruction.correct != 0:
            half = real(0.5)
            f = eigenvalue_correction(largest_eigenvalue(
                (xx - g_x * m_x) * one_W, (yy - g_y * m_y) * one_W, (zz - g_z * m_z) * one_W,
                (xy - half * (g_x * m_y + g_y * m_x)) * one_W,
                (xz - half * (g_x * m_z + g_z * m_x)) * one_W,
                (yz - half * (g_y * m_z + g_z * m_y)) * one_W,
            ))
        surface_distance[i] = field_value(W, m_x, m_y, m_z, f, reconstruction.radius)
        surface_temperature[i] = T / max(W, real(1e-12))  # 0 at the edge of the reach, without a jump
