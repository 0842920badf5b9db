"""Smoothing functions in two dimensions, each column with a support h of its own. Flood spec 0, E8.

``h`` is the support radius, twice the smoothing length l of the spline. All take r >= 0 [m] and return 0
beyond h without a branch, as in `melt.physics.smoothing`; the choice of function is loop-invariant. Where h
is, too (h_i in a loop over neighbours), 1/h leaves the loop.
"""

import math

from melt._compile import scalar
from melt.params import CUBIC


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
def dW2_over_r(r2, h, flood):
    """Return dW/dr / r [1/m^4] from r^2: finite at r = 0, where it is times x_ij = 0."""
    real = type(r2)
    inverse = real(1) / h
    r = math.sqrt(r2)
    q = r * inverse
    a = max(real(1) - q, real(0))
    scale = flood.sigma * (inverse * inverse) * (inverse * inverse)
    if flood.kernel == CUBIC:
        b = max(real(0.5) - q, real(0))
        # min(q, a)/q: 1 within h/2; the floor keeps 1/q finite
        return real(-240 / (7 * math.pi)) * scale * min(real(1), a / max(q, real(0.25))) * (a + real(2) * b)
    return real(-140 / math.pi) * scale * (a * a * a)


@scalar
def support_of(V, d, flood):
    """Return h = ratio sqrt(V/d), clamped; the largest for d <= 0 or NaN, so that a search stays bounded. E8."""
    h = flood.ratio * math.sqrt(V / d)
    # every comparison with NaN fails
    return max(h, flood.smallest) if h < flood.largest else flood.largest
