"""Exact steady flows in a channel: over a bump, and MacDonald's short channel with friction and a jump.

`Flow` as in `_flood_exact`; x [m], unit discharge q [m^2/s] towards positive x.
"""

import functools

import numpy as np
from scipy.optimize import brentq

from experiments._flood_exact import Flow, G, bump

#: (q [m^2/s], depth at the outlet [m]) of the flows over the bump; the second one leaves freely.
BUMPS = {"subcritical": (4.42, 2.0), "transcritical": (1.53, 0.66), "jump": (0.18, 0.33)}

MACDONALD_Q, MACDONALD_N, MACDONALD_JUMP, MACDONALD_END = 2.0, 0.0328, 200 / 3, 100.0


def critical_depth(q, g=G):
    """Return (q^2/g)^(1/3) [m]."""
    return (q * q / g) ** (1 / 3)


def bernoulli_depth(head, q, fast, g=G):
    """Return the depth [m] of d + q^2/(2 g d^2) = head (array): the larger root, or the supercritical one where ``fast``.

    Trigonometric roots of d^3 - E d^2 + k = 0, k = q^2/2g: d = E/3 (1 + 2 cos(phi/3)), cos phi = 1 - 27k/(2E^3), and the
    same with (phi + 4 pi)/3. Clipped to the critical state where the head is too small for q.
    """
    head = np.asarray(head, float)
    phi = np.arccos(np.clip(1 - 27 * q * q / (4 * g * head**3), -1.0, 1.0))
    return head / 3 * (1 + 2 * np.cos((phi + np.where(fast, 4 * np.pi, 0.0)) / 3))


def bump_jump(q=0.18, h_out=0.33, g=G, crest=10.0, end=12.0, bed=bump):
    """Return where [m] the water jumps between crest and end of the bump.

    Momentum q^2/d + g d^2/2 of the fast water that has critical head at the crest equals that of the slow water that has
    the outlet's head.
    """
    top = 1.5 * critical_depth(q, g) + float(bed(crest))
    out = h_out + q * q / (2 * g * h_out**2)

    def surplus(x):
        fast, slow = bernoulli_depth(top - bed(x), q, True, g), bernoulli_depth(out - bed(x), q, False, g)
        return float(q * q / fast + 0.5 * g * fast**2 - q * q / slow - 0.5 * g * slow**2)

    # on the lee side the slow branch exists only where the outlet's head carries q
    least = 1.5 * critical_depth(q, g)
    start = crest if out - float(bed(crest)) >= least else brentq(lambda x: out - float(bed(x)) - least, crest, end)
    return brentq(surplus, start, end, xtol=1e-12)


def bump_flow(x, kind, g=G, smooth=False):
    """Return the steady flow of `BUMPS` over `bump`: d + b + q^2/(2 g d^2) constant on either side of a jump."""
    x = np.asarray(x, float)
    q, h_out = BUMPS[kind]

    def bed(x):
        return bump(x, smooth)

    b = bed(x)
    out = h_out + q * q / (2 * g * h_out**2)
    if kind == "subcritical":
        d = bernoulli_depth(out - b, q, False, g)
    else:
        d = bernoulli_depth(1.5 * critical_depth(q, g) + bed(10.0) - b, q, x > 10.0, g)
        if kind == "jump":
            d = np.where(x > bump_jump(q, h_out, g, bed=bed), bernoulli_depth(np.maximum(out - b, 1e-3), q, False, g), d)
    return Flow(d, q / d, b)


def _macdonald_depths(g):
    """Return the depths [m] before and after the jump as polynomials of r = x/100 - 2/3."""
    k = (4 / g) ** (1 / 3)
    before = np.polynomial.Polynomial([2 / 3 * k, -k - 0.6, -0.9])  # k (4/3 - x/100) - 9x/1000 (x/100 - 2/3)
    after = k * np.polynomial.Polynomial([1.4305, 14.492, -21.7112, 0.674202, 0.674202])
    return before, after


@functools.cache
def _gauss():
    return np.polynomial.legendre.leggauss(60)


def _macdonald_fall(lower, upper, depth, g):
    """Return the integral of b_x = (q^2/(g d^3) - 1) d_x - n^2 q^2/d^(10/3) from ``lower`` to ``upper`` [m] (arrays)."""
    node, weight = _gauss()
    half = 0.5 * (upper - lower)
    r = ((0.5 * (upper + lower))[..., None] + half[..., None] * node) / 100 - 2 / 3
    d, q = depth(r), MACDONALD_Q
    slope = (q * q / (g * d**3) - 1) * depth.deriv()(r) / 100 - (MACDONALD_N * q) ** 2 / d ** (10 / 3)
    return half * (slope @ weight)


def macdonald_short(x, g=G):
    """Return MacDonald's short channel: 0 <= x <= 100 m, q = 2 m^2/s, Manning 0.0328, slow - fast - jump at 200/3 m - slow.

    The depth is prescribed, and the bed follows from b(100) = 0 by quadrature.
    """
    x = np.asarray(x, float)
    before, after = _macdonald_depths(g)
    first = x < MACDONALD_JUMP
    d = np.where(first, before(x / 100 - 2 / 3), after(x / 100 - 2 / 3))
    jump, end = np.float64(MACDONALD_JUMP), np.float64(MACDONALD_END)
    bed = -_macdonald_fall(np.maximum(x, jump), end, after, g) - _macdonald_fall(np.minimum(x, jump), jump, before, g)
    return Flow(d, MACDONALD_Q / d, bed)


def froude(flow, g=G):
    """Return |u|/sqrt(g d), 0 where dry."""
    return np.abs(flow.velocity) / np.sqrt(g * np.where(flow.depth > 0, flow.depth, np.inf))
