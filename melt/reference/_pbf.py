"""Pair tables of the position based fluid: float64, dense, in the symbols of boiling spec 2."""

import numpy as np

from melt.reference._pairs import separations


def pair_supports(position, support_radius, pbf):
    """Return R_ij (n, n) [m]; a particle without a radius takes its partner's, two without have 0."""
    n = position.shape[1]
    if pbf.uniform == 1:
        return np.full((n, n), float(pbf.support))
    R = support_radius.astype(np.float64)
    R_i, R_j = np.broadcast_to(R[:, None], (n, n)), np.broadcast_to(R[None, :], (n, n))
    return 0.5 * (np.where(R_i > 0, R_i, R_j) + np.where(R_j > 0, R_j, R_i))


def listed(neighbour_count, neighbour_index):
    """Return which pairs (n, n) stand in the lists, and each particle with itself."""
    near = np.eye(len(neighbour_count), dtype=bool)
    for i, count in enumerate(neighbour_count):
        near[i, neighbour_index[i, :count]] = True
    return near


def scale(row, R, kernel_scale, pbf):
    """Return a row of the kernel table at R, linear between its points."""
    if pbf.uniform == 1:
        cube = float(pbf.support) ** 3
        constant = float(pbf.value_scale) * cube if row == 0 else float(pbf.gradient_scale) * cube * float(pbf.support)
        return np.full_like(R, constant)
    points = float(pbf.table_start) + np.arange(int(pbf.table_last) + 1) / float(pbf.table_step)
    return np.interp(R / float(pbf.spacing), points, kernel_scale[row].astype(np.float64))


def value(r, R, kernel_scale, pbf):
    """Return W1_ij / S(R_ij) [1/m^3]."""
    return scale(0, R, kernel_scale, pbf) / R**3 * np.where(r < R, 1 - (r / R) ** 2, 0.0) ** 3


def gradient(x_ij, r, R, kernel_scale, pbf):
    """Return grad W2_ij / G(R_ij), shape as x_ij [1/m^4]; 0 for r < 1e-9 d."""
    apart = r > 1e-9 * float(pbf.spacing)
    size = scale(1, R, kernel_scale, pbf) / R**4 * np.where(r < R, 1 - r / R, 0.0) ** 2
    return np.where(apart, -size / np.where(apart, r, 1.0), 0.0) * x_ij


def tables(position, support_radius, kernel_scale, pbf):
    """Return x_ij, r_ij, R_ij, W_ij and grad W_ij of all pairs."""
    x_ij, r = separations(position)
    R = pair_supports(position, support_radius, pbf)
    R = np.where(R > 0, R, float(pbf.minimum_support))  # of pairs that never meet
    return x_ij, r, R, value(r, R, kernel_scale, pbf), gradient(x_ij, r, R, kernel_scale, pbf)
