"""CUDA twin of `melt.reference.viscous_cg`. Sums in float64: one thread for each of 64 shares, added in order."""

from melt._compile import cuda, cuda_kernel
from melt.cuda._viscous import adjoint_row, dot, shear_row
from melt.physics.viscous import block_times


@cuda_kernel
def _viscous_apply(
    mass, volume, viscous_direction, viscous_block, dilation, neighbour_count, neighbour_index, pair_gradient,
    pair_shear, dt, viscous_product,
):
    i = cuda.grid(1)
    if i >= mass.shape[0]:
        return
    real = type(dt)
    if not viscous_block[0, i] > real(0):
        for a in range(3):
            viscous_product[a, i] = real(0)
        return
    fx, fy, fz = shear_row(i, neighbour_count, neighbour_index, pair_shear, viscous_direction)
    c = mass[i] / dt
    x = c * viscous_direction[0, i] + fx
    y = c * viscous_direction[1, i] + fy
    z = c * viscous_direction[2, i] + fz
    if dilation.shape[0] > 0:
        px, py, pz = adjoint_row(i, neighbour_count, neighbour_index, pair_gradient, volume, dilation)
        x, y, z = x + px, y + py, z + pz
    viscous_product[0, i], viscous_product[1, i], viscous_product[2, i] = x, y, z


def viscous_apply(
    mass, volume, viscous_direction, viscous_block, dilation, neighbour_count, neighbour_index, pair_gradient,
    pair_shear, dt, viscous_product, viscous_sums,
):
    """See `melt.reference.viscous_cg.viscous_apply`."""
    _viscous_apply.launch(
        mass.shape[0], mass, volume, viscous_direction, viscous_block, dilation, neighbour_count,
        neighbour_index, pair_gradient, pair_shear, dt, viscous_product,
    )
    dot.launch(64, viscous_direction, viscous_product, 1, viscous_sums)


@cuda_kernel
def _viscous_step(viscous_direction, viscous_product, velocity, viscous_residual, viscous_sums):
    i = cuda.grid(1)
    if i >= viscous_residual.shape[1]:
        return
    real = viscous_residual.dtype.type
    wide = viscous_sums.dtype.type
    old, curvature = wide(0), wide(0)
    for share in range(64):
        old += viscous_sums[0, share]
        curvature += viscous_sums[1, share]
    a = real(old / curvature) if curvature > wide(0) else real(0)
    for k in range(3):
        velocity[k, i] += a * viscous_direction[k, i]
        viscous_residual[k, i] -= a * viscous_product[k, i]


@cuda_kernel
def _preconditioned(viscous_residual, viscous_block, viscous_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    wide = viscous_sums.dtype.type
    n = viscous_residual.shape[1]
    total = wide(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        x, y, z = viscous_residual[0, i], viscous_residual[1, i], viscous_residual[2, i]
        dx, dy, dz = block_times(viscous_block, i, x, y, z)
        total += wide(x) * wide(dx) + wide(y) * wide(dy) + wide(z) * wide(dz)
    viscous_sums[2, share] = total


def viscous_step(
    viscous_direction, viscous_product, viscous_block, velocity, viscous_residual, viscous_sums,
):
    """See `melt.reference.viscous_cg.viscous_step`."""
    _viscous_step.launch(
        viscous_residual.shape[1], viscous_direction, viscous_product, velocity, viscous_residual, viscous_sums
    )
    _preconditioned.launch(64, viscous_residual, viscous_block, viscous_sums)
    dot.launch(64, viscous_residual, viscous_residual, 3, viscous_sums)


@cuda_kernel
def _viscous_turn(viscous_residual, viscous_block, viscous_direction, viscous_sums):
    i = cuda.grid(1)
    if i >= viscous_residual.shape[1]:
        return
    real = viscous_residual.dtype.type
    wide = viscous_sums.dtype.type
    old, new = wide(0), wide(0)
    for share in range(64):
        old += viscous_sums[0, share]
        new += viscous_sums[2, share]
    b = real(new / old) if old > wide(0) else real(0)
    x, y, z = block_times(viscous_block, i, viscous_residual[0, i], viscous_residual[1, i], viscous_residual[2, i])
    viscous_direction[0, i] = x + b * viscous_direction[0, i]
    viscous_direction[1, i] = y + b * viscous_direction[1, i]
    viscous_direction[2, i] = z + b * viscous_direction[2, i]


@cuda_kernel
def _keep_sums(viscous_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    viscous_sums[0, share] = viscous_sums[2, share]


def viscous_turn(viscous_residual, viscous_block, viscous_direction, viscous_sums):
    """See `melt.reference.viscous_cg.viscous_turn`."""
    _viscous_turn.launch(
        viscous_residual.shape[1], viscous_residual, viscous_block, viscous_direction, viscous_sums
    )
    _keep_sums.launch(64, viscous_sums)


@cuda_kernel
def _viscous_keep(dilation, viscous_pressure):
    i = cuda.grid(1)
    if i >= viscous_pressure.shape[0]:
        return
    viscous_pressure[i] -= dilation[i]


def viscous_keep(dilation, viscous_pressure):
    """See `melt.reference.viscous_cg.viscous_keep`."""
    _viscous_keep.launch(viscous_pressure.shape[0], dilation, viscous_pressure)
