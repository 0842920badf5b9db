"""Scalar formulas of implicit viscosity and of its law. Slime spec 2.11."""

import math

from melt._compile import scalar, scalar_lookup
from melt.params import VISCOSITY_ARRHENIUS, VISCOSITY_EXPONENTIAL
from melt.physics.smoothing import dW_over_r


@scalar
def thermal_viscosity(T, viscous):
    """Return the viscosity [Pa s] at a temperature [degC]; at a shear rate of 1/s where the liquid thins."""
    real = type(T)
    low = viscous.reference_temperature - T
    if viscous.law == VISCOSITY_ARRHENIUS:
        # 1/T - 1/T0 written as one fraction: the difference of two reciprocals would lose half of float32
        zero = real(273.15)
        return viscous.mu * math.exp(viscous.slope * low / ((T + zero) * (viscous.reference_temperature + zero)))
    if viscous.law == VISCOSITY_EXPONENTIAL:
        return viscous.mu * math.exp(viscous.slope * low)
    return viscous.mu


@scalar
def apparent_viscosity(mu, rate, viscous):
    """Return the uncapped viscosity [Pa s] of a Herschel-Bulkley liquid at a shear rate [1/s]."""
    real = type(mu)
    eta = mu
    if viscous.power != real(1):
        eta = mu * max(rate, real(1e-6)) ** (viscous.power - real(1))
    turns = viscous.yield_rate * rate
    if turns > real(1e-9):
        return eta - viscous.yield_stress * math.expm1(-turns) / rate
    return eta + viscous.yield_stress * viscous.yield_rate  # the limit at rest


@scalar
def capped(mu, viscous):
    """Return a viscosity within the limits."""
    return min(max(mu, viscous.smallest), viscous.largest)


@scalar
def shear_factor(mu_i, mu_j, V_i, V_j, r2, smoothing, viscous):
    """Return sqrt(k_ij) [(kg/s)^(1/2)/m], w_ij = sqrt(k_ij) x_ij; mu_j = 0: a wall.

    Products in an order in which i and j may change places: w_ij = -w_ji to the last bit.
    """
    real = type(r2)
    pair = real(2) * (mu_i * mu_j) / (mu_i + mu_j) if mu_j > real(0) else viscous.wall * mu_i
    F = -dW_over_r(r2, smoothing)
    return math.sqrt((viscous.strength * pair) * ((V_i * V_j) * F) / (r2 + viscous.floor))


@scalar
def inverse_block(xx, yy, zz, xy, xz, yz):
    """Return the inverse of a symmetric positive definite 3x3 matrix, by its L D L^T factors.

    Not by cofactors: next to a single neighbour the matrix is of rank one but for m/dt, and the
    determinant would be a difference of nearly equal terms.
    """
    real = type(xx)
    d1 = real(1) / xx
    a, b = xy * d1, xz * d1
    d2 = real(1) / (yy - a * xy)
    e = yz - a * xz
    c = e * d2
    d3 = real(1) / (zz - b * xz - c * e)
    p = a * c - b  # entry (3, 1) of the inverse of L
    return (
        d1 + a * a * d2 + p * p * d3, d2 + c * c * d3, d3, -a * d2 - p * c * d3, p * d3, -c * d3,
    )


@scalar_lookup
def block_times(viscous_block, i, x, y, z):
    """Return the product of the i-th symmetric block (6, n) with a vector."""
    xy, xz, yz = viscous_block[3, i], viscous_block[4, i], viscous_block[5, i]
    return (
        viscous_block[0, i] * x + xy * y + xz * z,
        xy * x + viscous_block[1, i] * y + yz * z,
        xz * x + yz * y + viscous_block[2, i] * z,
    )
