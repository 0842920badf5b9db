"""CUDA twin of `melt.reference.poisson_cg`. Sums in float64: one thread for each of 64 shares, added in order."""

from melt._compile import cuda, cuda_kernel
from melt.cuda._poisson import dot


@cuda_kernel
def _poisson_apply(
    poisson_direction, poisson_ghost, neighbour_count, neighbour_index, pair_poisson, poisson_product,
):
    i = cuda.grid(1)
    if i >= poisson_direction.shape[0]:
        return
    d, product = poisson_direction[i], poisson_direction.dtype.type(0)
    for k in range(neighbour_count[i]):
        product += pair_poisson[i, k] * (d - poisson_direction[neighbour_index[i, k]])
    poisson_product[i] = product + poisson_ghost[i] * d


def poisson_apply(
    poisson_direction, poisson_ghost, neighbour_count, neighbour_index, pair_poisson, poisson_product, poisson_sums,
):
    """See `melt.reference.poisson_cg.poisson_apply`."""
    _poisson_apply.launch(
        poisson_direction.shape[0], poisson_direction, poisson_ghost, neighbour_count, neighbour_index,
        pair_poisson, poisson_product,
    )
    dot.launch(64, poisson_direction, poisson_product, 1, poisson_sums)


@cuda_kernel
def _poisson_step(poisson_direction, poisson_product, poisson_pressure, poisson_residual, poisson_sums):
    i = cuda.grid(1)
    if i >= poisson_residual.shape[0]:
        return
    real = poisson_residual.dtype.type
    wide = poisson_sums.dtype.type
    old, curvature = wide(0), wide(0)
    for share in range(64):
        old += poisson_sums[0, share]
        curvature += poisson_sums[1, share]
    a = real(old / curvature) if curvature > wide(0) else real(0)
    poisson_pressure[i] += a * poisson_direction[i]
    poisson_residual[i] -= a * poisson_product[i]


@cuda_kernel
def _preconditioned(poisson_residual, poisson_diagonal, poisson_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    wide = poisson_sums.dtype.type
    n = poisson_residual.shape[0]
    rz = rr = wide(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        r, diagonal = wide(poisson_residual[i]), wide(poisson_diagonal[i])
        if diagonal > wide(0):
            rz += r * (r / diagonal)
            rr += r * r
    poisson_sums[2, share] = rz
    poisson_sums[3, share] = rr


def poisson_step(
    poisson_direction, poisson_product, poisson_diagonal, poisson_pressure, poisson_residual, poisson_sums,
):
    """See `melt.reference.poisson_cg.poisson_step`."""
    _poisson_step.launch(
        poisson_residual.shape[0], poisson_direction, poisson_product, poisson_pressure, poisson_residual,
        poisson_sums,
    )
    _preconditioned.launch(64, poisson_residual, poisson_diagonal, poisson_sums)


@cuda_kernel
def _poisson_turn(poisson_residual, poisson_diagonal, poisson_direction, poisson_sums):
    i = cuda.grid(1)
    if i >= poisson_residual.shape[0]:
        return
    real = poisson_residual.dtype.type
    wide = poisson_sums.dtype.type
    old, new = wide(0), wide(0)
    for share in range(64):
        old += poisson_sums[0, share]
        new += poisson_sums[2, share]
    b = real(new / old) if old > wide(0) else real(0)
    z = poisson_residual[i] / poisson_diagonal[i] if poisson_diagonal[i] > real(0) else real(0)
    poisson_direction[i] = z + b * poisson_direction[i]


@cuda_kernel
def _keep_sums(poisson_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    poisson_sums[0, share] = poisson_sums[2, share]


def poisson_turn(poisson_residual, poisson_diagonal, poisson_direction, poisson_sums):
    """See `melt.reference.poisson_cg.poisson_turn`."""
    _poisson_turn.launch(
        poisson_residual.shape[0], poisson_residual, poisson_diagonal, poisson_direction, poisson_sums
    )
    _keep_sums.launch(64, poisson_sums)
