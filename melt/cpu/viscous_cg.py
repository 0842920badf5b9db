"""CPU twin of `melt.reference.viscous_cg`. Sums in float64: 64 shares of particles, added in order."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.cpu._viscous import adjoint_row, shear_row
from melt.physics.viscous import block_times


@cpu_stage
def viscous_apply(
    mass, volume, viscous_direction, viscous_block, dilation, neighbour_count, neighbour_index, pair_gradient,
    pair_shear, dt, viscous_product, viscous_sums,
):
    """See `melt.reference.viscous_cg.viscous_apply`."""
    real = type(dt)
    wide = np.float64
    n = mass.shape[0]
    augmented = dilation.shape[0] > 0
    for chunk in prange(64):
        share = (chunk * 37) % 64  # dealt out: walls have no pairs
        total = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            if not viscous_block[0, i] > real(0):
                for a in range(np.uint64(3)):
                    viscous_product[a, i] = real(0)
                continue
            fx, fy, fz = shear_row(i, neighbour_count, neighbour_index, pair_shear, viscous_direction)
            c = mass[i] / dt
            u, v, w = viscous_direction[0, i], viscous_direction[1, i], viscous_direction[2, i]
            x, y, z = c * u + fx, c * v + fy, c * w + fz
            if augmented:
                px, py, pz = adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, dilation)
                x, y, z = x + px, y + py, z + pz
            viscous_product[0, i], viscous_product[1, i], viscous_product[2, i] = x, y, z
            total += wide(u) * wide(x) + wide(v) * wide(y) + wide(w) * wide(z)
        viscous_sums[1, share] = total


@cpu_stage
def viscous_step(
    viscous_direction, viscous_product, viscous_block, velocity, viscous_residual, viscous_sums,
):
    """See `melt.reference.viscous_cg.viscous_step`."""
    real = viscous_residual.dtype.type
    wide = np.float64
    n = viscous_residual.shape[1]
    old, curvature = wide(0), wide(0)
    for share in range(64):
        old += viscous_sums[0, share]
        curvature += viscous_sums[1, share]
    a = real(old / curvature) if curvature > wide(0) else real(0)
    for share in prange(64):
        rz = rr = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            for k in range(3):
                velocity[k, i] += a * viscous_direction[k, i]
            x = viscous_residual[0, i] - a * viscous_product[0, i]
            y = viscous_residual[1, i] - a * viscous_product[1, i]
            z = viscous_residual[2, i] - a * viscous_product[2, i]
            viscous_residual[0, i], viscous_residual[1, i], viscous_residual[2, i] = x, y, z
            dx, dy, dz = block_times(viscous_block, i, x, y, z)
            rz += wide(x) * wide(dx) + wide(y) * wide(dy) + wide(z) * wide(dz)
            rr += wide(x) * wide(x) + wide(y) * wide(y) + wide(z) * wide(z)
        viscous_sums[2, share], viscous_sums[3, share] = rz, rr


@cpu_stage
def viscous_turn(viscous_residual, viscous_block, viscous_direction, viscous_sums):
    """See `melt.reference.viscous_cg.viscous_turn`."""
    real = viscous_residual.dtype.type
    wide = np.float64
    n = viscous_residual.shape[1]
    old, new = wide(0), wide(0)
    for share in range(64):
        old += viscous_sums[0, share]
        new += viscous_sums[2, share]
    b = real(new / old) if old > wide(0) else real(0)
    for share in prange(64):
        for i in range(share * n // 64, (share + 1) * n // 64):
            x, y, z = block_times(
                viscous_block, i, viscous_residual[0, i], viscous_residual[1, i], viscous_residual[2, i]
            )
            viscous_direction[0, i] = x + b * viscous_direction[0, i]
            viscous_direction[1, i] = y + b * viscous_direction[1, i]
            viscous_direction[2, i] = z + b * viscous_direction[2, i]
    for share in range(64):
        viscous_sums[0, share] = viscous_sums[2, share]


@cpu_stage
def viscous_keep(dilation, viscous_pressure):
    """See `melt.reference.viscous_cg.viscous_keep`."""
    for i in prange(viscous_pressure.shape[0]):
        viscous_pressure[i] -= dilation[i]
