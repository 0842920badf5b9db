"""Conjugate gradients of implicit viscosity, with the inverse diagonal blocks as preconditioner. Slime spec 2.11."""

import numpy as np

from melt.reference._shares import rows, shares


def viscous_apply(
    mass, volume, viscous_direction, viscous_block, dilation, neighbour_count, neighbour_index, pair_gradient,
    pair_shear, dt, viscous_product, viscous_sums,
):
    r"""Write A d = M/dt d + K d + D^T V y, y = \gamma D d, and the partial sums of d.Ad (row 1).

    Reads: mass (n,) [kg], volume (n,) [m^3], viscous_direction (3, n) [m/s] d, viscous_block (6, n) (0: velocity
        given, product 0), dilation (n,) [Pa] of d or length 0, the lists, pair_gradient, pair_shear (3, n, m).
    Writes: viscous_product (3, n) [kg m/s^2], viscous_sums (5, 64) row 1.
    """
    d = viscous_direction.astype(float)
    for i, near in rows(neighbour_count, neighbour_index):
        viscous_product[:, i] = 0
        if not viscous_block[0, i] > 0:
            continue
        w = pair_shear[:, i, : len(near)].astype(float)
        total = float(mass[i]) / float(dt) * d[:, i] + w @ (w * (d[:, i, None] - d[:, near])).sum(axis=0)
        if len(dilation):
            y = dilation.astype(float)
            total -= float(volume[i]) * pair_gradient[:, i, : len(near)].astype(float) @ (y[i] + y[near])
        viscous_product[:, i] = total
    viscous_sums[1] = [s.sum() for s in shares((d * viscous_product).sum(axis=0))]


def _preconditioned(block, r):
    """Return z (3, n) = B r."""
    xx, yy, zz, xy, xz, yz = block.astype(float)
    B = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.einsum("abi,bi->ai", B, r.astype(float))


def viscous_step(
    viscous_direction, viscous_product, viscous_block, velocity, viscous_residual, viscous_sums,
):
    """Write v += a d, r -= a A d, a = r.z/d.Ad, and the partial sums of the new r.z (row 2) and r.r (row 3).

    a = 0 where the curvature d.Ad is not positive.

    Reads: viscous_direction (3, n) [m/s], viscous_product (3, n) [kg m/s^2], viscous_block (6, n) [s/kg].
    Writes: velocity (3, n) [m/s], viscous_residual (3, n) [kg m/s^2], viscous_sums (5, 64) rows 2, 3.
    """
    curvature = viscous_sums[1].sum()
    a = viscous_sums[0].sum() / curvature if curvature > 0 else 0.0
    velocity[:] = velocity + a * viscous_direction
    viscous_residual[:] = viscous_residual - a * viscous_product
    r = viscous_residual.astype(float)
    viscous_sums[2] = [s.sum() for s in shares((r * _preconditioned(viscous_block, r)).sum(axis=0))]
    viscous_sums[3] = [s.sum() for s in shares((r * r).sum(axis=0))]


def viscous_turn(viscous_residual, viscous_block, viscous_direction, viscous_sums):
    """Write d = B r + b d, b = new r.z / old r.z, and move the new sums into row 0.

    Reads: viscous_residual (3, n) [kg m/s^2], viscous_block (6, n) [s/kg], viscous_sums (5, 64) rows 0, 2.
    Writes: viscous_direction (3, n) [m/s], viscous_sums row 0.
    """
    old = viscous_sums[0].sum()
    b = viscous_sums[2].sum() / old if old > 0 else 0.0
    viscous_direction[:] = _preconditioned(viscous_block, viscous_residual) + b * viscous_direction
    viscous_sums[0] = viscous_sums[2]


def viscous_keep(dilation, viscous_pressure):
    r"""Write p -= \gamma D v, the multiplier's step of the augmented Lagrangian. (n,) [Pa] both."""
    viscous_pressure[:] = viscous_pressure.astype(float) - dilation
