"""Scalars of vapour: pair kernels of Mueller 2003 with both radii, effect precision. Boiling spec 2.6."""

import math

from melt._compile import scalar


@scalar
def poly6_pair(r2, support):
    r"""Return poly6 :math:`\frac{315}{64\pi R^9}(R^2 - r^2)^3` [1/m^3]; 0 beyond R."""
    real = type(r2)
    inverse = real(1) / support
    b = max(real(1) - r2 * (inverse * inverse), real(0))
    return real(315 / (64 * math.pi)) * (inverse * inverse * inverse) * (b * b * b)


@scalar
def spiky_pair_over_r(r2, support, vapour):
    """Return f >= 0 with spiky grad W_ij = -f x_ij [1/m^5]; 0 beyond R and for r < 1e-9 R'."""
    real = type(r2)
    tiny = real(1e-18) * vapour.support * vapour.support
    inverse = real(1) / support
    over_r = real(1) / math.sqrt(max(r2, tiny))
    a = max(real(1) - r2 * over_r * inverse, real(0))
    square = inverse * inverse
    f = real(45 / math.pi) * (square * square) * (a * a) * over_r
    return f if r2 > tiny else real(0)


@scalar
def vapour_radius(density, densest, push, strongest, vapour):
    """Return R'_i of eq (16) from density, size of the pressure force, and the largest of both around."""
    real = type(density)
    if vapour.adapt == 0:
        return vapour.support
    by_density = density / densest if densest > real(0) else real(1)
    by_push = push / strongest if strongest > real(0) else real(1)
    a = vapour.density_share
    return max((a * by_density + (real(1) - a) * by_push) * vapour.support, vapour.minimum_support)
