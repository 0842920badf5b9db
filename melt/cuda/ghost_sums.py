"""CUDA twin of `melt.reference.ghost_sums`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.period import near_cell, wrap
from melt.physics.phases import LIQUID
from melt.physics.search import axis_cell
from melt.physics.smoothing import W, dW_over_r


@cuda_kernel
def _ghost_volume(
    position, phase, volume, cell_start, ghost_position, ghost_start, grid, smoothing, period, ghost_volume,
):
    g = cuda.grid(1)
    capacity = ghost_position.shape[1]
    if g >= min(ghost_start[ghost_start.shape[0] - 1], capacity):
        return
    real = type(smoothing.support)
    x_g, y_g, z_g = ghost_position[0, g], ghost_position[1, g], ghost_position[2, g]
    c_x = axis_cell(x_g, grid.origin_x, grid.inverse_cell, grid.nx)
    c_y = axis_cell(y_g, grid.origin_y, grid.inverse_cell, grid.ny)
    c_z = axis_cell(z_g, grid.origin_z, grid.inverse_cell, grid.nz)
    total = real(0)
    for n in range(27):
        m_x = near_cell(c_x, n % 3, grid.nx, period.length_x)
        m_y = near_cell(c_y, n // 3 % 3, grid.ny, period.length_y)
        m_z = near_cell(c_z, n // 9, grid.nz, period.length_z)
        if m_x < 0 or m_y < 0 or m_z < 0:
            continue
        m = m_x + grid.nx * (m_y + grid.ny * m_z)
        for j in range(cell_start[m], cell_start[m + 1]):
            if phase[j] == LIQUID and not volume[j] > real(0):
                continue
            x = real(wrap(x_g - position[0, j], period.length_x, period.inverse_x))
            y = real(wrap(y_g - position[1, j], period.length_y, period.inverse_y))
            z = real(wrap(z_g - position[2, j], period.length_z, period.inverse_z))
            total += W(math.sqrt(x * x + y * y + z * z), smoothing)
        for k in range(ghost_start[m], min(ghost_start[m + 1], capacity)):
            x = real(wrap(x_g - ghost_position[0, k], period.length_x, period.inverse_x))
            y = real(wrap(y_g - ghost_position[1, k], period.length_y, period.inverse_y))
            z = real(wrap(z_g - ghost_position[2, k], period.length_z, period.inverse_z))
            total += W(math.sqrt(x * x + y * y + z * z), smoothing)
    ghost_volume[g] = real(1) / total


def ghost_volume(
    position, phase, volume, cell_start, ghost_position, ghost_start, grid, smoothing, period, ghost_volume,
):
    """See `melt.reference.ghost_sums.ghost_volume`."""
    _ghost_volume.launch(
        ghost_position.shape[1], position, phase, volume, cell_start, ghost_position, ghost_start, grid, smoothing,
        period, ghost_volume,
    )


@cuda_kernel
def _ghost_complete(
    position, density_ratio, dfsph_factor, ghost_position, ghost_volume, ghost_start, grid, smoothing, period, poisson,
    completed_ratio, ghost_laplacian,
):
    i = cuda.grid(1)
    if i >= density_ratio.shape[0]:
        return
    real = type(smoothing.support)
    s = density_ratio[i]
    completed_ratio[i] = s
    ghost_laplacian[i] = real(0)
    if not dfsph_factor[i] > real(0):
        return
    capacity = ghost_position.shape[1]
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    c_x = axis_cell(x_i, grid.origin_x, grid.inverse_cell, grid.nx)
    c_y = axis_cell(y_i, grid.origin_y, grid.inverse_cell, grid.ny)
    c_z = axis_cell(z_i, grid.origin_z, grid.inverse_cell, grid.nz)
    more = laplacian = real(0)
    for n in range(27):
        m_x = near_cell(c_x, n % 3, grid.nx, period.length_x)
        m_y = near_cell(c_y, n // 3 % 3, grid.ny, period.length_y)
        m_z = near_cell(c_z, n // 9, grid.nz, period.length_z)
        if m_x < 0 or m_y < 0 or m_z < 0:
            continue
        m = m_x + grid.nx * (m_y + grid.ny * m_z)
        for g in range(ghost_start[m], min(ghost_start[m + 1], capacity)):
            x = real(wrap(x_i - ghost_position[0, g], period.length_x, period.inverse_x))
            y = real(wrap(y_i - ghost_position[1, g], period.length_y, period.inverse_y))
            z = real(wrap(z_i - ghost_position[2, g], period.length_z, period.inverse_z))
            r2 = x * x + y * y + z * z
            more += ghost_volume[g] * W(math.sqrt(r2), smoothing)
            laplacian -= ghost_volume[g] * dW_over_r(r2, smoothing) * (r2 / (r2 + poisson.floor))
    completed_ratio[i] = min(s + more, max(s, real(1)))
    ghost_laplacian[i] = laplacian


def ghost_complete(
    position, density_ratio, dfsph_factor, ghost_position, ghost_volume, ghost_start, grid, smoothing, period, poisson,
    completed_ratio, ghost_laplacian,
):
    """See `melt.reference.ghost_sums.ghost_complete`."""
    _ghost_complete.launch(
        density_ratio.shape[0], position, density_ratio, dfsph_factor, ghost_position, ghost_volume, ghost_start, grid,
        smoothing, period, poisson, completed_ratio, ghost_laplacian,
    )
