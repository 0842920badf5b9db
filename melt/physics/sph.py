"""Pairs of Mueller 2003's weakly compressible SPH: raw poly6, spiky gradient, viscosity Laplacian. Boiling spec 1, 2.0."""

import math

from melt._compile import scalar
from melt.physics.phases import BUBBLE, LIQUID


@scalar
def displaced(phase, rest_volume):
    """Return the volume [m^3] by which a partner displaces liquid: vapour and free slots have none."""
    return rest_volume if phase <= BUBBLE else type(rest_volume)(0)


@scalar
def poly6_raw(r2, sph):
    """Return W1 [1/m^3] from r^2; 0 beyond the support."""
    real = type(r2)
    R = sph.support
    b = max(real(1) - r2 * (real(1) / (R * R)), real(0))
    return real(315 / (64 * math.pi)) / (R * R * R) * (b * b * b)


@scalar
def pair_factors(r2, phase, rest_volume, density, pressure, pressure_i, sph):
    """Return (f, g) of a partner: its share in rho_i a_i is f x_ij + g (v_j - v_i).

    Everything but liquid carries the pressure P_i; bubbles slip, vapour does nothing. f is 0 for r < 1e-9 R.
    """
    real = type(r2)
    R = sph.support
    tiny = real(1e-18) * R * R
    over_r = real(1) / math.sqrt(max(r2, tiny))
    q = max(real(1) - r2 * over_r * (real(1) / R), real(0))
    wet = phase == LIQUID
    V = displaced(phase, rest_volume) * (sph.rest_density / density if wet else real(1))
    P = real(0.5) * (pressure_i + (pressure if wet else pressure_i))
    R2 = R * R
    scale = real(45 / math.pi) / (R2 * R2) * V * q
    f = scale * q * over_r * P if r2 > tiny else real(0)
    g = scale / R * sph.viscosity if phase < BUBBLE else real(0)
    return f, g
