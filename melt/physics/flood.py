"""Columns with a support h of their own: smoothing functions in two dimensions, depth, reach. Flood spec 0, 1.5, E8, E9.

``h`` is the support radius, twice the smoothing length l of the spline. All take r >= 0 [m] and return 0
beyond h without a branch, as in `melt.physics.smoothing`; the choice of function is loop-invariant. Where h
is, too (h_i in a loop over neighbours), 1/h leaves the loop.
"""

import math

import numpy as np

from melt._compile import scalar
from melt.params import CUBIC

LEAST_SLOPE = 0.05  # of R in `better_depth`: a column with hardly any neighbour has none


@scalar
def W2(r, h, flood):
    """Return W(r, h) [1/m^2]: cubic spline or Wendland C2, times the discrete normalisation sigma."""
    real = type(r)
    q = r * (real(1) / h)
    a = max(real(1) - q, real(0))
    if flood.kernel == CUBIC:
        # 40/(7 pi h^2) (6q^3 - 6q^2 + 1 | 2(1-q)^3) in one form
        b = max(real(0.5) - q, real(0))
        return flood.sigma * real(80 / (7 * math.pi)) / (h * h) * (a * a * a - real(4) * b * b * b)
    a2 = a * a
    return flood.sigma * real(7 / math.pi) / (h * h) * (a2 * a2) * (real(4) * q + real(1))


@scalar
def dW2(r, h, flood):
    """Return dW/dr(r, h) <= 0 [1/m^3]. The gradient is dW2(r) x_ij / r."""
    real = type(r)
    q = r * (real(1) / h)
    a = max(real(1) - q, real(0))
    if flood.kernel == CUBIC:
        # min(q, a) = a - 2b without its cancellation
        b = max(real(0.5) - q, real(0))
        return flood.sigma * real(-240 / (7 * math.pi)) / (h * h * h) * min(q, a) * (a + real(2) * b)
    return flood.sigma * real(-140 / math.pi) / (h * h * h) * q * (a * a * a)


@scalar
def support_of(V, d, flood):
    """Return h = ratio sqrt(V/d), clamped; the largest for d <= 0 or NaN, so that a search stays bounded. E8."""
    h = flood.ratio * math.sqrt(V / d)
    # every comparison with NaN fails
    return max(h, flood.smallest) if h < flood.largest else flood.largest


@scalar
def scales2(flood):
    """Return (c, e) with W = c w / h^2 and -r dW/dr = e t / h^2 for the (w, t) of `weights2`."""
    real = type(flood.sigma)
    c = flood.sigma * real(80 / (7 * math.pi) if flood.kernel == CUBIC else 7 / math.pi)
    return c, c * (real(3) if flood.kernel == CUBIC else real(20))


@scalar
def weights2(q, flood):
    """Return (w, t) at q = r/h: W and -r dW/dr but for their factors, with as few operations as both together need."""
    real = type(q)
    a = max(real(1) - q, real(0))
    a2 = a * a
    if flood.kernel == CUBIC:
        b = max(real(0.5) - q, real(0))
        b2 = real(4) * (b * b)
        return a2 * a - b2 * b, q * (a2 - b2)
    return a2 * a2 * (real(4) * q + real(1)), q * q * (a2 * a)


@scalar
def support_limit(h, flood):
    """Return the largest support that a column may take from h on: the growth, within the clamps."""
    reach = flood.growth * h
    # every comparison with NaN fails
    return max(reach, flood.smallest) if reach < flood.largest else flood.largest


@scalar
def wall_share(gamma, flood):
    """Return the share s of walls that keeps 1 - s gamma at ``shortest_wall`` at least. E14."""
    real = type(gamma)
    most = real(1) - flood.shortest_wall
    return most / gamma if gamma > most else real(1)


@scalar
def inverse_support(d, per, low, high):
    """Return 1/h at depth d, with ``per`` = 1/(ratio^2 V), clamped to [low, high]; low, the widest, for d <= 0 or NaN. E8."""
    inverse = math.sqrt(d * per)
    return min(inverse, high) if inverse > low else low


@scalar
def better_depth(d, R, S_water, alpha, gamma, free):
    """Return the depth after a Newton step on R(d); ``free``: the support is not clamped. E9.

    Free, a step changes d by a factor of 2 at most. Clamped, R is linear in d but for walls that get wet or
    dry, and d is what the water alone sums up to at least. Comparisons let NaN through.
    """
    real = type(d)
    twice = d + d
    # R / [(2R + alpha)/(2d) - gamma] with one division
    slope = max(real(2) * R + alpha - twice * gamma, real(LEAST_SLOPE) * twice) if free else real(1) - gamma
    wanted = d - (R * twice if free else R) / slope
    low = real(0.5) * d if free else S_water
    if free and wanted > twice:
        return twice
    return low if wanted < low else wanted


@scalar
def squared_in_plane(x, y):
    """Return x^2 + y^2; nothing is fused on the CPU, so that all loops that call it agree on who is near."""
    return x * x + y * y


@scalar
def squared_reach(h, flood):
    """Return (growth h)^2, 0 for NaN."""
    real = type(h)
    reach = flood.growth * h
    return reach * reach if reach > real(0) else real(0)


@scalar
def outermost_ring(h, growth, inverse_cell, rings):
    """Return the largest k <= rings with growth h > (k - 1) cell edges; 0 for h = 0 or NaN."""
    real = type(h)
    t = growth * h * inverse_cell
    if t >= real(rings):
        return np.int32(rings)
    if t > real(0):
        k = np.int32(t)  # k + 1 fails the test where t is whole
        return k + np.int32(1) if real(k) < t else k
    return np.int32(0)
