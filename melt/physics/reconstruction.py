"""Scalar formulas of the surface reconstruction. Melting spec 2.8."""

import math

from melt._compile import scalar


@scalar
def reconstruction_weight(r2, reach):
    """Return w = (1 - r^2/R^2)^3 within the reach R, 0 beyond, without a branch."""
    real = type(r2)
    a = max(real(1) - r2 / (reach * reach), real(0))
    return a * a * a


@scalar
def weight_slope(r2, reach):
    """Return g [1/m^2] with grad_x w(x - x_j) = g (x_j - x)."""
    real = type(r2)
    a = max(real(1) - r2 / (reach * reach), real(0))
    return real(6) / (reach * reach) * a * a


@scalar
def largest_eigenvalue(xx, yy, zz, xy, xz, yz):
    """Return the largest eigenvalue of a symmetric 3x3 matrix in closed form (Smith 1961)."""
    real = type(xx)
    third = real(1 / 3)
    mean = (xx + yy + zz) * third
    a, b, c = xx - mean, yy - mean, zz - mean
    p = math.sqrt((a * a + b * b + c * c + real(2) * (xy * xy + xz * xz + yz * yz)) * real(1 / 6))
    if not p > real(0):
        return mean
    a, b, c, d, e, f = a / p, b / p, c / p, xy / p, xz / p, yz / p
    half = real(0.5) * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e))
    return mean + real(2) * p * _cosine(math.acos(min(max(half, real(-1)), real(1))) * third)


@scalar
def _cosine(t):
    """Return cos t for t in 0 .. pi/3, by its series to t^18 (libdevice's cosf computes in float64)."""
    real = type(t)
    u = t * t
    c = real(1)
    for k in range(18, 0, -2):
        c = real(1) - c * u * (real(1) / real(k * (k - 1)))
    return c


@scalar
def eigenvalue_correction(eigenvalue):
    """Return f in 0 .. 1: 1 below 0.4, else g^3 - 3 g^2 + 3 g with g = (3.5 - EV)/3.1, 0 above 3.5."""
    real = type(eigenvalue)
    g = min(max((real(3.5) - eigenvalue) * real(1 / 3.1), real(0)), real(1))
    return ((g - real(3)) * g + real(3)) * g


@scalar
def field_value(W, x, y, z, f, radius):
    """Return phi = |(x, y, z)| - f r, cut off at +r; +r where no particle has weight.

    (x, y, z) points from the node to the weighted mean of the particles. The cut changes no
    zero, and makes phi continuous where the last particle leaves the reach.
    """
    if W > type(W)(0):
        return min(math.sqrt(x * x + y * y + z * z) - f * radius, radius)
    return radius
