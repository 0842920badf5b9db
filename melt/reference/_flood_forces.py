"""Pair tables of the forces between columns: float64, dense, in the symbols of flood spec 2."""

import numpy as np

from melt.reference._flood import dW2
from melt.reference._philox import pair_direction

TINY, APART = 1e-6, 1e-3  # columns closer than TINY h count as APART h from each other


def dW_over_r(r, h, flood):
    """Return W'(r)/r [1/m^4]; 0 at r = 0, where the gradient vanishes."""
    return dW2(r, h, flood) / np.where(r > 0, r, 1.0)


def separated(id, position, h):
    """Return x_ij = x_i - x_j in the plane, (2, n, n), and r_ij, (n, n) [m].

    Two columns at one place are taken apart along a direction that their ids draw.
    """
    x = position[:2].astype(np.float64)
    x_ij = x[:, :, None] - x[:, None, :]
    r = np.sqrt((x_ij**2).sum(axis=0))
    mean = 0.5 * (h[:, None] + h[None, :])
    for i, j in zip(*np.nonzero((r < TINY * mean) & ~np.eye(len(h), dtype=bool))):
        n = np.array(pair_direction(int(id[i]), int(id[j]))[:2])
        r[i, j] = APART * mean[i, j]
        x_ij[:, i, j] = r[i, j] * n / np.sqrt(n @ n)
    return x_ij, r


def specific_pressure(d, flood):
    """Return P/d^2 [m/s^2] with P = p/rho_w [m^3/s^2] of the depth-integrated pressure p. E6.

    Hydrostatic, P = g d^2/2: the constant g/2. Form 3, the paper's p = k (rho - rho_0) with areal densities
    rho = rho_w d, so P = k (d - d_ref).
    """
    if flood.form != 3:
        return np.full_like(d, 0.5 * float(flood.gravity))
    P = float(flood.stiffness) * (d - float(flood.reference_depth))
    return np.where((flood.clamp == 1) & (P < 0), 0.0, P) / d**2


def stabilisation(x_ij, r, v_ij, h, d, F, flood):
    """Return Pi_ij of E10 and what (v_j - v_i) is multiplied with by E7, both with m_j/rho_bar_ij = V_j/d_bar_ij.

    F (n, n) is the mean of the two W'/r. l and d are means of the two columns, so that pairs are antisymmetric.
    """
    c = np.sqrt(float(flood.gravity) * d)
    ell = 0.25 * (h[:, None] + h[None, :])
    c_ij, d_ij = 0.5 * (c[:, None] + c[None, :]), 0.5 * (d[:, None] + d[None, :])
    vx = (v_ij * x_ij).sum(axis=0)
    Pi = -float(flood.lax_friedrichs) * c_ij * np.minimum(vx, 0.0) / (d_ij * np.sqrt(r**2 + 0.01 * ell**2))  # E10
    return Pi, float(flood.viscosity) * 2 * np.abs(F) * r / (r + 0.01 * ell) / d_ij  # E7
