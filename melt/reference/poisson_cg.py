"""Conjugate gradients of the pressure Poisson equation, with its diagonal as preconditioner. Slime spec 2.9."""

import numpy as np

from melt.reference._shares import rows, shares


def poisson_apply(
    poisson_direction, poisson_ghost, neighbour_count, neighbour_index, pair_poisson, poisson_product, poisson_sums,
):
    """Write S d and the partial sums of d.Sd (row 1).

    Differences d_i - d_j, not the diagonal times d_i: a constant is in the null space of closed liquid exactly.

    Reads: poisson_direction (n,) [Pa] d, poisson_ghost (n,) [m], the lists, pair_poisson (n, m) [m].
    Writes: poisson_product (n,) [N/m], poisson_sums (5, 64) row 1.
    """
    d = poisson_direction.astype(float)
    for i, near in rows(neighbour_count, neighbour_index):
        s = pair_poisson[i, : len(near)].astype(float)
        poisson_product[i] = (s * (d[i] - d[near])).sum() + float(poisson_ghost[i]) * d[i]
    poisson_sums[1] = [share.sum() for share in shares(d * poisson_product)]


def _preconditioned(diagonal, r):
    """Return z = r/diagonal, 0 without pressure."""
    return r.astype(float) / np.where(diagonal > 0, diagonal, np.inf)


def poisson_step(
    poisson_direction, poisson_product, poisson_diagonal, poisson_pressure, poisson_residual, poisson_sums,
):
    """Write p += a d, r -= a S d, a = r.z/d.Sd, and the partial sums of the new r.z (row 2) and r.r (row 3).

    a = 0 where the curvature d.Sd is not positive.

    Reads: poisson_direction (n,) [Pa], poisson_product (n,) [N/m], poisson_diagonal (n,) [m].
    Writes: poisson_pressure (n,) [Pa], poisson_residual (n,) [N/m], poisson_sums (5, 64) rows 2, 3.
    """
    curvature = poisson_sums[1].sum()
    a = poisson_sums[0].sum() / curvature if curvature > 0 else 0.0
    poisson_pressure[:] = poisson_pressure + a * poisson_direction
    poisson_residual[:] = poisson_residual - a * poisson_product
    r = poisson_residual.astype(float)
    poisson_sums[2] = [share.sum() for share in shares(r * _preconditioned(poisson_diagonal, r))]
    poisson_sums[3] = [share.sum() for share in shares(r * r)]


def poisson_turn(poisson_residual, poisson_diagonal, poisson_direction, poisson_sums):
    """Write d = z + b d, b = new r.z / old r.z, and move the new sums into row 0.

    Reads: poisson_residual (n,) [N/m], poisson_diagonal (n,) [m], poisson_sums (5, 64) rows 0, 2.
    Writes: poisson_direction (n,) [Pa], poisson_sums row 0.
    """
    old = poisson_sums[0].sum()
    b = poisson_sums[2].sum() / old if old > 0 else 0.0
    poisson_direction[:] = _preconditioned(poisson_diagonal, poisson_residual) + b * poisson_direction
    poisson_sums[0] = poisson_sums[2]
