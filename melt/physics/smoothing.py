"""Smoothing functions with support h, normalised in three dimensions or in the plane. Melting spec 2.1, slime spec 0.

All take r >= 0 [m] and the `melt.params.Smoothing` tuple and return 0 beyond the support
without a branch: (1 - q) is clamped instead. The choice of function is loop-invariant, so
the compiler moves it out of the neighbour loop (measured: no cost).
"""

import math

from melt._compile import scalar
from melt.params import CUBIC, L_BROOK_REGULAR, L_VISC, WENDLAND2


@scalar
def W(r, smoothing):
    """Return W(r) [1/m^3; 1/m^2 in the plane]: cubic spline, Wendland C2, or poly6 (three dimensions only)."""
    real = type(r)
    h = smoothing.support
    q = r * (real(1) / h)  # the reciprocal leaves the neighbour loop, a division by h would not
    a = max(real(1) - q, real(0))
    if smoothing.kernel == CUBIC:
        # 8/(pi h^3) (6q^3 - 6q^2 + 1 | 2(1-q)^3) in one branch-free form
        b = max(real(0.5) - q, real(0))
        flat = smoothing.dimension == 2
        scale = real(80 / (7 * math.pi)) / (h * h) if flat else real(16 / math.pi) / (h * h * h)
        return scale * (a * a * a - real(4) * b * b * b)
    if smoothing.kernel == WENDLAND2:
        a2 = a * a
        flat = smoothing.dimension == 2
        scale = real(7 / math.pi) / (h * h) if flat else real(21 / (2 * math.pi)) / (h * h * h)
        return scale * a2 * a2 * (real(4) * q + real(1))
    a = max(real(1) - q * q, real(0))
    return real(315 / (64 * math.pi)) / (h * h * h) * a * a * a


@scalar
def dW(r, smoothing):
    """Return W'(r) <= 0 [1/m^4]; spiky where W is poly6. The gradient is dW(r) x_ij / r."""
    real = type(r)
    h = smoothing.support
    q = r * (real(1) / h)
    a = max(real(1) - q, real(0))
    h3 = h * h * h
    flat = smoothing.dimension == 2
    if smoothing.kernel == CUBIC:
        # min(q, a) = a - 2b without its cancellation: W'/r stays exact as r -> 0
        b = max(real(0.5) - q, real(0))
        scale = real(-240 / (7 * math.pi)) / h3 if flat else real(-48 / math.pi) / (h3 * h)
        return scale * min(q, a) * (a + real(2) * b)
    if smoothing.kernel == WENDLAND2:
        scale = real(-140 / math.pi) / h3 if flat else real(-210 / math.pi) / (h3 * h)
        return scale * q * a * a * a
    return real(-45 / math.pi) / (h3 * h) * a * a


@scalar
def dW_over_r(r2, smoothing):
    """Return W'(r)/r [1/m^5] from r^2, defined as 0 for r < 1e-9 h (the gradient vanishes)."""
    real = type(r2)
    h = smoothing.support
    # the floor keeps 1/r finite; the result is dropped below it
    r = math.sqrt(max(r2, real(1e-18) * h * h))
    factor = dW(r, smoothing) / r
    return factor if r2 > real(1e-18) * h * h else real(0)


@scalar
def laplacian_weight(r, smoothing):
    """Return L(r) >= 0 [1/m^5] with Sum V_j (f_j - f_i) L_ij -> laplacian(f).

    ``L_VISC`` 45/(pi h^6)(h - r); ``L_BROOK`` -2 W'(r)/r; ``L_BROOK_REGULAR``
    -2 W' r/(r^2 + 0.01 (h/2)^2). Never the true Laplacian of W: it is negative near r = 0
    and heat would flow from cold to hot.
    """
    real = type(r)
    h = smoothing.support
    if smoothing.laplacian == L_VISC:
        h3 = h * h * h
        return real(45 / math.pi) / (h3 * h3) * max(h - r, real(0))
    floor = real(0.0025) * h * h if smoothing.laplacian == L_BROOK_REGULAR else real(0)
    safe = max(r, real(1e-9) * h)
    return real(-2) * dW(safe, smoothing) * safe / (safe * safe + floor)
