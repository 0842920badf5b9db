"""Scalar formulas of the ISPH pressure Poisson equation. Slime spec 2.9."""

from melt._compile import scalar
from melt.physics.smoothing import dW_over_r


@scalar
def present_volume(V, ratio):
    """Return the volume of a particle at its completed density ratio, at most twice that at rest [m^3]."""
    return V / max(ratio, type(V)(0.5))


@scalar
def poisson_entry(V_i, V_j, r2, smoothing, poisson):
    """Return s_ij = s_ji >= 0 [m], to the last bit: i and j may change places in every product."""
    F = -dW_over_r(r2, smoothing)
    return type(r2)(2) * (V_i * V_j) * F * (r2 / (r2 + poisson.floor))


@scalar
def wall_rise(x, y, z, ax, ay, az, p, poisson):
    """Return rho_0 (g - a).d, what water that moves with a wall would add from here to d = (x, y, z) in it [Pa].

    (ax, ay, az) is g - a; within 6 p where there may be a surface.
    """
    rise = poisson.rest_density * (ax * x + ay * y + az * z)
    most = type(p)(6) * max(p, type(p)(0)) if poisson.full > type(p)(0) else type(p)(1e30)
    return max(-most, min(rise, most))
