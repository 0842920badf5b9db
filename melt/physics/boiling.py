"""Heat of the boiling liquid and what it does to velocities: one pair, one particle. Boiling spec 2.0, 2.3, 2.4."""

import math

import numpy as np

from melt._compile import scalar, scalar_lookup
from melt.params import BOOST_BOUSSINESQ, BOOST_LITERAL, BOOST_RATE


@scalar
def viscosity_laplacian(r2, R):
    """Return lap W3 = 45/(pi R^6) (R - r) [1/m^5] >= 0 from r^2; 0 beyond R. W3 itself is singular and never used."""
    real = type(r2)
    inverse = real(1) / R
    square = inverse * inverse
    a = real(1) - math.sqrt(r2) * inverse
    return real(45 / math.pi) * (real(0) if a < real(0) else a) * (square * square * inverse)  # NaN stays NaN


@scalar_lookup
def heat_weight(i, j, r2, R, V_j, heat_sum, constraint, boiling):
    """Return the weight [1/m^2] of T_j - T_i in lap T: V_j L_ij of (11), or (m_j/rho_j) lap W3 of (10).

    L_ij = lap W3 2/(th_i + th_j); a pair without neighbours to speak of (th_i + th_j < 1e-6) does not conduct.
    """
    real = type(r2)
    lap = V_j * viscosity_laplacian(r2, R)
    if boiling.corrected == 1:
        both = heat_sum[i] + heat_sum[j]
        return real(0) if both < real(1e-6) else lap * (real(2) / both)
    return lap / (real(1) + constraint[j])


@scalar
def approach(T, target, share):
    """Return a temperature brought closer to ``target`` by ``share`` of the difference; exactly there for 1."""
    return T + share * (target - T) if share < type(T)(1) else target


@scalar
def gain(before, after):
    """Return after - before as rounding left it.

    A scalar, because a loop with fastmath may cancel (T + dT) - T and give the change that was meant.
    """
    return after - before


@scalar
def heated(x, y, boiling):
    """Return whether (x, y) is over the heated part of the floor."""
    along = x >= boiling.heater_lower_x and x <= boiling.heater_upper_x
    return along and y >= boiling.heater_lower_y and y <= boiling.heater_upper_y


@scalar
def hotness(T, boiling):
    """Return theta = (T - T_0)/(T_b - T_0) within 0 and 1; a step where T_0 is not below T_b."""
    real = type(T)
    span = boiling.boiling_point - boiling.start_temperature
    if span > real(0):
        return min(max((T - boiling.start_temperature) / span, real(0)), real(1))
    return real(1) if T >= boiling.boiling_point else real(0)


@scalar
def viscosity_ratio(T):
    r"""Return mu(T)/mu(20 C) of water, T in degC: Vogel's formula mu = exp(A + B/(T_K - C)), B = 578.919 K, C = 137.546 K.

    1 at 20, 0.2827 at 100 C (A drops out); measured 0.2814. Below 0 C as at 0.
    """
    real = type(T)
    above = max(T, real(0)) + real(135.604)  # T_K - C
    return math.exp(real(578.919 / 155.604) * (real(155.604) - above) / above)


@scalar
def between_cells(x, origin, inverse_cell, count):
    """Return (k, share) of coordinate x: the value is that of centre k and ``share`` of the way to k + 1.

    Clamped to the outermost centres, where share is 0 or k + 1 the last cell; NaN is at the first.
    """
    real = type(inverse_cell)
    t = real(x - type(x)(origin)) * inverse_cell - real(0.5)
    if not t > real(0):
        return np.int32(0), real(0)
    if t >= real(count - 1):
        return np.int32(count - 1), real(0)
    k = np.int32(t)
    return k, t - real(k)


@scalar
def boosted(u, v, w, T, mean_u, mean_v, mean_w, mean_T, fluid, boiling, dt):
    """Return the velocity (u, v, w) of a particle after the boost (12) in the mode ``boiling.boost``."""
    real = type(u)
    if boiling.boost == BOOST_RATE:
        x, y, z = u - mean_u, v - mean_v, w - mean_w
        share = (x * x + y * y + z * z) / (boiling.boost_speed * boiling.boost_speed)
        f = boiling.boost_rate * hotness(T, boiling) * dt * max(real(1) - share, real(0))
        return u + f * x, v + f * y, w + f * z
    if boiling.boost == BOOST_LITERAL:
        f = real(1) + boiling.boost_rate * hotness(T, boiling)
        return f * u, f * v, f * w
    if boiling.boost == BOOST_BOUSSINESQ:
        f = -dt * boiling.expansion * (T - mean_T)
        return u + f * fluid.gravity_x, v + f * fluid.gravity_y, w + f * fluid.gravity_z
    return u, v, w


@scalar_lookup
def sampled(x, y, z, voxel_temperature, tank):
    """Return the temperature of the grid at a place [degC], linear between cell centres.

    Without fastmath: a thread's last particles, outside its SIMD loop, would be rounded otherwise.
    """
    T, one = voxel_temperature, type(tank.inverse_cell)(1)
    kx, p = between_cells(x, tank.origin_x, tank.inverse_cell, tank.nx)
    ky, q = between_cells(y, tank.origin_y, tank.inverse_cell, tank.ny)
    kz, r = between_cells(z, tank.origin_z, tank.inverse_cell, tank.nz)
    dx = 1 if kx < tank.nx - 1 else 0
    dy = tank.nx if ky < tank.ny - 1 else 0
    dz = tank.nx * tank.ny if kz < tank.nz - 1 else 0
    c = kx + tank.nx * (ky + tank.ny * kz)
    low = (one - q) * ((one - p) * T[c] + p * T[c + dx]) + q * ((one - p) * T[c + dy] + p * T[c + dy + dx])
    c += dz
    high = (one - q) * ((one - p) * T[c] + p * T[c + dx]) + q * ((one - p) * T[c + dy] + p * T[c + dy + dx])
    return (one - r) * low + r * high
