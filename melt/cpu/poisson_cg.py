"""CPU twin of `melt.reference.poisson_cg`. Sums in float64: 64 shares of particles, added in order."""

import numpy as np

from melt._compile import cpu_stage, prange


@cpu_stage
def poisson_apply(
    poisson_direction, poisson_ghost, neighbour_count, neighbour_index, pair_poisson, poisson_product, poisson_sums,
):
    """See `melt.reference.poisson_cg.poisson_apply`."""
    real = poisson_direction.dtype.type
    wide = np.float64
    n = poisson_direction.shape[0]
    for chunk in prange(64):
        share = (chunk * 37) % 64  # dealt out: walls have no pairs
        total = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            d, product = poisson_direction[i], real(0)
            for k in range(np.uint64(neighbour_count[i])):
                product += pair_poisson[i, k] * (d - poisson_direction[np.uint64(neighbour_index[i, k])])
            product += poisson_ghost[i] * d
            poisson_product[i] = product
            total += wide(d) * wide(product)
        poisson_sums[1, share] = total


@cpu_stage
def poisson_step(
    poisson_direction, poisson_product, poisson_diagonal, poisson_pressure, poisson_residual, poisson_sums,
):
    """See `melt.reference.poisson_cg.poisson_step`."""
    real = poisson_residual.dtype.type
    wide = np.float64
    n = poisson_residual.shape[0]
    old, curvature = wide(0), wide(0)
    for share in range(64):
        old += poisson_sums[0, share]
        curvature += poisson_sums[1, share]
    a = real(old / curvature) if curvature > wide(0) else real(0)
    for share in prange(64):
        rz = rr = wide(0)
        for i in range(share * n // 64, (share + 1) * n // 64):
            poisson_pressure[i] += a * poisson_direction[i]
            r = poisson_residual[i] - a * poisson_product[i]
            poisson_residual[i] = r
            if poisson_diagonal[i] > real(0):
                rz += wide(r) * (wide(r) / wide(poisson_diagonal[i]))
                rr += wide(r) * wide(r)
        poisson_sums[2, share], poisson_sums[3, share] = rz, rr


@cpu_stage
def poisson_turn(poisson_residual, poisson_diagonal, poisson_direction, poisson_sums):
    """See `melt.reference.poisson_cg.poisson_turn`."""
    real = poisson_residual.dtype.type
    wide = np.float64
    n = poisson_residual.shape[0]
    old, new = wide(0), wide(0)
    for share in range(64):
        old += poisson_sums[0, share]
        new += poisson_sums[2, share]
    b = real(new / old) if old > wide(0) else real(0)
    for share in prange(64):  # fixed shares: a vectorised division and that of a loop's rest may round apart
        for i in range(share * n // 64, (share + 1) * n // 64):
            z = poisson_residual[i] / poisson_diagonal[i] if poisson_diagonal[i] > real(0) else real(0)
            poisson_direction[i] = z + b * poisson_direction[i]
    for share in range(64):
        poisson_sums[0, share] = poisson_sums[2, share]
