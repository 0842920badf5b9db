"""Kernels of the position based fluid: poly6 W1 and spiky grad W2, each made exact on the lattice. Boiling spec 2.0.

A pair uses R_ij = (R_i + R_j)/2; a partner without a radius of its own (wall, solid) takes the liquid's.
With effect precision off all R are equal and the coefficients are constants of `melt.params.Pbf`: the
choice is the same for all pairs, so the compiler takes it out of the neighbour loops.
"""

import math

import numpy as np

from melt._compile import scalar, scalar_lookup


@scalar_lookup
def scale_at(ratio, row, kernel_scale, pbf):
    """Return the entry of a row of the kernel table at R/d = ``ratio``, linear between its points."""
    real = type(ratio)
    t = min(max((ratio - pbf.table_start) * pbf.table_step, real(0)), real(pbf.table_last))
    k = min(np.int32(t), np.int32(pbf.table_last - 1))
    part = t - real(k)
    point = np.uint64(k)
    low, high = kernel_scale[row, point], kernel_scale[row, point + np.uint64(1)]
    return low + part * (high - low)


@scalar_lookup
def pair_scales(i, j, support_radius, kernel_scale, pbf):
    """Return 1/R_ij, the scale of W1 [1/m^3] and that of |grad W2| [1/m^4] of a pair (i = j: of itself)."""
    real = type(pbf.support)
    if pbf.uniform == 1:
        return real(1) / pbf.support, pbf.value_scale, pbf.gradient_scale
    R_i, R_j = support_radius[i], support_radius[j]
    R = real(0.5) * (R_i + (R_j if R_j > real(0) else R_i))
    ratio, inverse = R * (real(1) / pbf.spacing), real(1) / R
    cube = inverse * inverse * inverse
    value = scale_at(ratio, 0, kernel_scale, pbf) * cube
    return inverse, value, scale_at(ratio, 1, kernel_scale, pbf) * cube * inverse


@scalar_lookup
def support_of(i, j, support_radius, pbf):
    """Return R_ij [m]."""
    real = type(pbf.support)
    if pbf.uniform == 1:
        return pbf.support
    R_i, R_j = support_radius[i], support_radius[j]
    return real(0.5) * ((R_i if R_i > real(0) else R_j) + (R_j if R_j > real(0) else R_i))


@scalar
def poly6(r2, inverse, value):
    """Return W1 from r^2, 1/R and its scale; 0 beyond R."""
    real = type(r2)
    b = max(real(1) - r2 * (inverse * inverse), real(0))
    return value * (b * b * b)


@scalar
def xsph_weight(r2, inverse, m_i, m_j, V_i, V_j):
    """Return m_j/(m_i + m_j) (V_i + V_j) W1 of a pair in (8), with the plain poly6: it is a filter, no density."""
    real = type(r2)
    W1 = poly6(r2, inverse, real(315 / (64 * math.pi)) * inverse * inverse * inverse)
    return m_j / (m_i + m_j) * (V_i + V_j) * W1


@scalar
def spiky_over_r(r2, inverse, gradient, pbf):
    """Return f >= 0 with grad W2 = -f x_ij, from r^2, 1/R and the scale; 0 beyond R and for r < 1e-9 d."""
    real = type(r2)
    tiny = real(1e-18) * pbf.spacing * pbf.spacing
    over_r = real(1) / math.sqrt(max(r2, tiny))
    a = max(real(1) - r2 * over_r * inverse, real(0))
    f = gradient * a * a * over_r
    return f if r2 > tiny else real(0)


@scalar
def repulsion(r2, inverse, pbf):
    r"""Return s_ij <= 0 [kg m^2], :math:`-(k_s/D_0) (W(r)/W(\Delta q))^4`: the scales cancel.

    Below 1e-12 the ratio counts as 0: its product with mass and volume would be a denormal float32 for the
    many pairs of a lattice that are just within R (measured: 5.5 instead of 2.6 ns per pair).
    """
    real = type(r2)
    b = max(real(1) - r2 * (inverse * inverse), real(0)) * pbf.push_scale
    b3 = b * b * b
    b6 = b3 * b3
    b12 = b6 * b6
    return -pbf.push * (b12 if b12 > real(1e-12) else real(0))


@scalar_lookup
def acts(whole, j, iterations, iteration):
    """Return whether a pair acts in an iteration: the particle itself still iterates, or its partner does."""
    if whole:
        return True
    return iterations[j] > iteration


@scalar
def correction_factor(r2, inverse, gradient, V_i, lambda_i, V_j, lambda_j, mobility_j, pbf):
    """Return f of the pair's share f x_ij of the correction (6), before omega w_i.

    A partner that does not move (wall) pushes and never pulls; it has no multiplier of its own.
    """
    real = type(r2)
    s = real(0.5) * repulsion(r2, inverse, pbf)
    own = lambda_i if mobility_j > real(0) else min(lambda_i, real(0))
    bracket = own * V_j + lambda_j * V_i + s * (V_i + V_j)
    return -bracket * spiky_over_r(r2, inverse, gradient, pbf)


@scalar
def cut(x, y, z, most):
    """Return the factor that brings a vector to the length ``most``, 1 if it is not longer."""
    real = type(most)
    size2 = x * x + y * y + z * z
    if size2 > most * most:
        return most / math.sqrt(size2)
    return real(1)
