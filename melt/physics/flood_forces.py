"""Forces between columns of water. Flood spec 2, E6, E7, E10, E16.

A column j pushes i by V_j (f x_ij + g (v_j - v_i)). The neighbour loop of the CPU twin calls the short scalars (one
long one would not be inlined, and then nothing vectorises: 5 times as slow); `pair_factors` is the same in one piece.
"""

import math

from melt._compile import scalar, scalar_lookup
from melt.params import CUBIC, FORM_LINEAR, FORM_VARIATIONAL
from melt.physics.philox import pair_direction
from melt.physics.terrain import bed_value

OPEN = 0.15  # |S| l from which a column may stand beside a void (E6, wb)
CONE = 0.5  # square of the cosine: 45 degrees about the way into the void
TINY, APART = 1e-6, 1e-3  # columns closer than TINY h count as APART h from each other


@scalar
def slope_scale(inverse, flood):
    """Return what `slope_shape` is multiplied with to give dW/dr [1/m^3]; ``inverse`` is 1/h."""
    real = type(inverse)
    scale = flood.sigma * (inverse * inverse * inverse)
    if flood.kernel == CUBIC:
        return real(-240 / (7 * math.pi)) * scale
    return real(-140 / math.pi) * scale


@scalar
def slope_shape(q, flood):
    """Return the shape of dW/dr over q = r/h, as in `melt.physics.flood.dW2`: there 1/h^3 costs a division per pair."""
    real = type(q)
    a = max(real(1) - q, real(0))
    if flood.kernel == CUBIC:
        return min(q, a) * (a + real(2) * max(real(0.5) - q, real(0)))
    return q * (a * a * a)


@scalar
def pressure_divisor(depth, support_factor, flood):
    """Return what c of E6 is divided by: Omega, or d^2 of the linear equation of state, or 1."""
    if flood.form == FORM_LINEAR:
        return depth * depth
    return support_factor if flood.form == FORM_VARIATIONAL else type(depth)(1)


@scalar
def pressure_weight(depth, inverse, flood):
    """Return c [m/s^2] of E6, the pressure over rho_w d^2: hydrostatic g/2; ``inverse`` is 1/`pressure_divisor`."""
    real = type(depth)
    if flood.form == FORM_LINEAR:
        P = flood.stiffness * (depth - flood.reference_depth)
        if flood.clamp == 1:
            P = real(0) if P < real(0) else P  # NaN stays
        return P * inverse
    return real(0.5) * flood.gravity * inverse


@scalar
def own_weight(depth, support_factor, flood):
    """Return `pressure_weight` of a column."""
    return pressure_weight(depth, type(depth)(1) / pressure_divisor(depth, support_factor, flood), flood)


@scalar
def pressure_pair(slope_i, slope_j, c_i, c_j, flood):
    """Return the pressure part of a pair from dW/dr(h_i), dW/dr(h_j). E6."""
    if flood.form == FORM_VARIATIONAL:
        return c_i * slope_i + c_j * slope_j
    return (c_i + c_j) * (type(c_i)(0.5) * (slope_i + slope_j))


@scalar
def stabilisation(r, vx, slope, h_sum, depth_i, depth_j, wave_i, flood):
    """Return Pi_ij dW/dr of E10 and the factor g of (v_j - v_i) of E7, per V_j; ``slope`` is the mean dW/dr.

    vx is v_ij . x_ij: only pairs that approach are slowed. Of E7, |grad W|/(r + 0.01 l) never changes sign.
    """
    real = type(r)
    ell = real(0.25) * h_sum
    root, near = math.sqrt(r * r + real(0.01) * ell * ell), r + real(0.01) * ell
    # one division for both; depth_i + depth_j and the sum of wave speeds are twice their means
    share = slope / ((depth_i + depth_j) * root * near)
    speed = flood.lax_friedrichs * (wave_i + math.sqrt(flood.gravity * depth_j))
    return -(speed * min(vx, real(0))) * (share * near), real(-4) * flood.viscosity * (share * root)


@scalar
def pair_slopes(r, h_i, h_j, flood):
    """Return dW/dr(h_i) and dW/dr(h_j)."""
    real = type(r)
    inverse_i, inverse_j = real(1) / h_i, real(1) / h_j
    slope_i = slope_scale(inverse_i, flood) * slope_shape(r * inverse_i, flood)
    return slope_i, slope_scale(inverse_j, flood) * slope_shape(r * inverse_j, flood)


@scalar
def pair_factors(x, y, u, v, depth_i, depth_j, h_i, h_j, c_i, c_j, flood):
    """Return (f, g) of a pair; x, y are x_i - x_j and u, v are v_j - v_i, c_i and c_j are `own_weight`."""
    r = math.sqrt(x * x + y * y)
    slope_i, slope_j = pair_slopes(r, h_i, h_j, flood)
    wave_i, mean = math.sqrt(flood.gravity * depth_i), type(r)(0.5) * (slope_i + slope_j)
    push, g = stabilisation(r, -(u * x + v * y), mean, h_i + h_j, depth_i, depth_j, wave_i, flood)
    return -(push + pressure_pair(slope_i, slope_j, c_i, c_j, flood)) / r, g


@scalar
def surface_rise(bed_i, bed_j, depth_i, depth_j):
    """Return eta_j - eta_i; differences of like terms first, so that little is lost high above the datum."""
    return (bed_j - bed_i) + (depth_j - depth_i)


@scalar
def balanced_factors(x, y, u, v, depth_i, depth_j, h_i, h_j, rise, flood):
    """Return (f, g) of a pair in the balanced form, without the front's pressure, and F of its share F x_ij in S."""
    r = math.sqrt(x * x + y * y)
    slope_i, slope_j = pair_slopes(r, h_i, h_j, flood)
    wave_i, mean = math.sqrt(flood.gravity * depth_i), type(r)(0.5) * (slope_i + slope_j)
    push, g = stabilisation(r, -(u * x + v * y), mean, h_i + h_j, depth_i, depth_j, wave_i, flood)
    F = mean / (depth_j * r)
    return -push / r - flood.gravity * rise * F, g, F


@scalar
def coincident(r, h_sum):
    """Return whether two columns stand at one place: closer than TINY times their mean h."""
    return r < type(r)(0.5 * TINY) * h_sum


@scalar
def separation(first, second, h_sum):
    """Return the x_i - x_j that two columns at one place are given, from their ids; it turns with their order."""
    real = type(h_sum)
    x, y, _ = pair_direction(first, second, h_sum)
    length = real(0.5 * APART) * h_sum / math.sqrt(x * x + y * y)
    return length * x, length * y


@scalar
def wall_slope(r, h, flood):
    """Return dW/dr / r [1/m^4]; 0 at r = 0."""
    real = type(r)
    inverse = real(1) / h
    return slope_scale(inverse, flood) * slope_shape(r * inverse, flood) / max(r, real(1e-9) * h)


@scalar
def wall_stage(above, flood):
    """Return what a wall carries [m] whose foot is ``above`` metres below the water surface beside it. E16.

    Twice the mirrored depth, as c_i is the pressure of the column alone, or (paper) the reference depth.
    """
    real = type(above)
    if flood.wall_mirror == 1:
        return real(2) * (real(0) if above < real(0) else above)  # NaN stays
    return flood.reference_depth


@scalar
def along_wall(a_x, a_y, g_x, g_y, xx, xy, yy, h):
    """Return the acceleration of a column with the part along the wall in full.

    Walls carry the stage of the column itself: with the share M_tt = t . M t that they take of its support, a surface that
    slopes along them pushes by 1 - M_tt of what it should (half at the wall; M = -sum A_b (W'/r) x_ib x_ib, a straight wall
    has M_tt = sum A_b W). g_x, g_y is sum A_b grad W, which points across the wall. A straight wall takes half at most.
    Midway between two walls G cancels, and its direction is noise: what is added fades with (l |G|)^2 below 0.001.
    """
    real = type(a_x)
    g2 = g_x * g_x + g_y * g_y
    if not g2 > real(0):
        return a_x, a_y
    taken = (xx * g_y * g_y - real(2) * xy * g_x * g_y + yy * g_x * g_x) / g2
    open_share = max(real(1) - taken, real(0.5))
    sided = real(0.25) * h * h * g2
    fade = sided / (sided + real(0.001))
    more = fade * (real(1) / open_share - real(1)) * (a_y * g_x - a_x * g_y) / g2
    return a_x - more * g_y, a_y + more * g_x


@scalar
def may_be_front(s_x, s_y, h):
    """Return whether the sum S of A_j grad W, which points into the water, is that of a column beside a void."""
    real = type(h)
    ell = real(0.5) * h
    return s_x * s_x + s_y * s_y > real(OPEN * OPEN) / (ell * ell)


@scalar
def stands_in_void(x, y, s_x, s_y, h):
    """Return whether a partner at (x, y) from the column, as x_i - x_j, stands where the void would be."""
    real = type(h)
    r2, ahead = x * x + y * y, x * s_x + y * s_y
    return r2 < h * h and ahead > real(0) and ahead * ahead > real(CONE) * r2 * (s_x * s_x + s_y * s_y)


@scalar_lookup
def front_share(x, y, s_x, s_y, surface, depth, h, terrain, terrain_grid):
    """Return epsilon of the balanced form at a void: how far the surface stands above the bed one l into it. E6 (wb)."""
    real, wide = type(h), type(x)
    step = real(0.5) * h / math.sqrt(s_x * s_x + s_y * s_y)
    t = (surface - bed_value(x - wide(step * s_x), y - wide(step * s_y), terrain, terrain_grid)) / depth
    t = real(0) if t < real(0) else t  # NaN stays
    return real(1) if t > real(1) else t


@scalar
def inner_share(most, depth, flood):
    """Return epsilon of the balanced form elsewhere, from the largest difference of surfaces. E6 (wb)."""
    real = type(depth)
    t = most / (flood.front * depth)
    t = real(1) if t > real(1) else t
    return t * t * (real(3) - real(2) * t)


@scalar
def bed_push(u, v, s_x, s_y, t_x, t_y, xx, yy, xy, flood):
    """Return the push lambda [m/s^2] of the bed, of curvature (xx, yy, xy), on a column that follows it. E6."""
    real = type(u)
    turn = xx * u * u + yy * v * v + real(2) * xy * u * v
    return (flood.gravity + turn - t_x * s_x - t_y * s_y) / (real(1) + s_x * s_x + s_y * s_y)


@scalar
def nan_to_infinity(x):
    """Return infinity for NaN, which would lose every comparison that follows."""
    return x if x == x else type(x)(math.inf)
