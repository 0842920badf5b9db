"""Heat exchange of one pair, and the enthalpy of one particle. Melting spec 2.5, 3.5.

A pair alone, stepped by backward Euler, exchanges q = g D / (1 + g s) with g = dt G_ij,
G_ij = kappa_ij V_i V_j L_ij, D = T_j - T_i and s = 1/C_i + 1/C_j: both temperatures stay
between the old ones for every dt and every conductivity, and C_i T_i + C_j T_j is kept.

A particle that changes phase at m has the enthalpy (from its frozen state at m)

    E = C_frozen (T - m) below,  0..L at T = m (the plateau),  L + C_molten (T - m) above.

C = inf marks a fixed temperature, heat_volume = 0 an insulated particle, L = 0 one that
does not change phase.
"""

import math

from melt._compile import scalar
from melt.params import HEAT_PAPER
from melt.physics.smoothing import laplacian_weight


@scalar
def pair_factor(w, k_i, k_j, s, heat):
    """Return q/D [J/K] of a pair; w = dt V_i V_j L_ij [m s], s = 1/C_i + 1/C_j [K/J].

    One division and no product that overflows in float32 at k = 1e30: the paper law is
    clamped (1e30 J/K already equalises every pair), the harmonic law is written with 1/k,
    which also makes k = 0 an insulator.
    """
    real = type(w)
    if heat.law == HEAT_PAPER:
        g = min((k_i + k_j) * w, real(1e30))
        return g / (real(1) + g * s)
    return w / (real(0.5) * (real(1) / k_i + real(1) / k_j) + w * s)


@scalar
def exchange_factor(g, s):
    """Return q/D = g / (1 + g s) [J/K] of a pair, g = dt G_ij; defined for g = 0 and g = inf."""
    real = type(g)
    return real(1) / (real(1) / g + s)


@scalar
def own_share(g, C_i, C_j):
    """Return f of T_i += f (T_j - T_i), what `exchange_factor` moves over a finite C_i.

    With a = g / C_i it is a / (1 + a (1 + C_i/C_j)): two divisions, and a is held where a
    (1 + C_i/C_j) stays finite in float32.
    """
    real = type(g)
    a = min(g * (real(1) / C_i), real(1e18))
    return a / (real(1) + a * (real(1) + C_i / C_j))


@scalar
def pair_weight(r, V_i, V_j, dt, smoothing):
    """Return w = dt V_i V_j L(r) [m s], in an order that neither under- nor overflows."""
    return (dt * V_i) * (V_j * laplacian_weight(r, smoothing))


@scalar
def cold_side(T, e, m, frozen, molten, L):
    """Return (dT/dq, room [J] until that slope changes) of a particle that takes up heat."""
    real = type(T)
    inf = real(math.inf)
    if frozen == inf:
        return real(0), inf
    if T < m:
        return real(1) / frozen, (m - T) * frozen
    if e < L:
        return real(0), L - e
    return real(1) / molten, inf


@scalar
def hot_side(T, e, m, frozen, molten, L):
    """Return (-dT/dq, room [J] until that slope changes) of a particle that gives off heat."""
    real = type(T)
    inf = real(math.inf)
    if frozen == inf:
        return real(0), inf
    if T > m:
        return real(1) / molten, (T - m) * molten
    if e > real(0) and L > real(0):
        return real(0), e
    return real(1) / frozen, inf


@scalar
def latent_heat(g, T_c, e_c, m_c, frozen_c, molten_c, L_c, T_h, e_h, m_h, frozen_h, molten_h, L_h):
    """Return the heat q >= 0 [J] that the colder particle c takes from the hotter one h.

    Backward Euler of the pair with both piecewise linear enthalpies, solved exactly:
    q = g (T_h(q) - T_c(q)). The left side grows, the right side falls, each along at most
    three straight pieces, so five pieces are walked at most. No overshoot at the ends of
    the plateaus, hence the maximum principle holds with latent heat too.
    """
    real = type(g)
    q = real(0)
    resistance = real(1) / g
    for _ in range(5):
        slope_c, room_c = cold_side(T_c, e_c, m_c, frozen_c, molten_c, L_c)
        slope_h, room_h = hot_side(T_h, e_h, m_h, frozen_h, molten_h, L_h)
        need = (T_h - T_c - q * resistance) / (resistance + slope_c + slope_h)
        if not need > real(0):
            break
        step = min(need, min(room_c, room_h))
        q += step
        if slope_c > real(0):
            T_c = m_c if step == room_c else T_c + step * slope_c
        else:
            e_c = L_c if step == room_c else e_c + step
        if slope_h > real(0):
            T_h = m_h if step == room_h else T_h - step * slope_h
        else:
            e_h = real(0) if step == room_h else e_h - step
        if step == need:
            break
    return q


@scalar
def enthalpy(T, e, m, frozen, molten, L):
    """Return the heat content [J] above 0 degC of the frozen state."""
    real = type(T)
    if L > real(0) and T > m:
        return frozen * m + molten * (T - m) + e
    return frozen * T + e


@scalar
def absorb(q, T, e, m, frozen, molten, L):
    """Return (T, latent energy) after the heat q [J] of either sign; E rises by exactly q.

    The two branches that stay off the plateau add to T directly: T - m would be rounded.
    """
    real = type(T)
    if frozen == real(math.inf) or q == real(0):
        return T, e
    if not L > real(0):
        return T + q / frozen, e
    if T < m and e <= real(0):
        above = T + q / frozen
        if above <= m:
            return above, e
    elif T > m and e >= L:
        below = T + q / molten
        if below >= m:
            return below, e
    E = e + q + (T - m) * (frozen if T < m else molten)
    if E < real(0):
        return m + E / frozen, real(0)
    if E <= L:
        return m, E
    return m + (E - L) / molten, L


@scalar
def heater_contains(x, y, z, size_x, size_y, size_z, shape, reach):
    """Return whether an offset (x, y, z) from a heater's centre is inside it or within reach."""
    real = type(x)
    if shape == 1:
        distance = math.sqrt(x * x + y * y + z * z) - size_x
    else:
        x = max(abs(x) - size_x, real(0))
        y = max(abs(y) - size_y, real(0))
        z = max(abs(z) - size_z, real(0))
        distance = math.sqrt(x * x + y * y + z * z)
    return distance <= reach


@scalar
def pair_latent(
    g, T_i, e_i, m_i, frozen_i, molten_i, L_i, T_j, e_j, m_j, frozen_j, molten_j, L_j,
):
    """Return (T_i, e_i, T_j, e_j) after the exchange of a pair with latent heat, g = dt G_ij."""
    real = type(g)
    if g == real(0) or T_i == T_j:
        return T_i, e_i, T_j, e_j
    if T_i < T_j:
        q = latent_heat(g, T_i, e_i, m_i, frozen_i, molten_i, L_i, T_j, e_j, m_j, frozen_j, molten_j, L_j)
    else:
        q = -latent_heat(g, T_j, e_j, m_j, frozen_j, molten_j, L_j, T_i, e_i, m_i, frozen_i, molten_i, L_i)
    T_i, e_i = absorb(q, T_i, e_i, m_i, frozen_i, molten_i, L_i)
    T_j, e_j = absorb(-q, T_j, e_j, m_j, frozen_j, molten_j, L_j)
    return T_i, e_i, T_j, e_j


@scalar
def add_compensated(total, rest, e):
    """Return (total + e, rest + what that sum rounded off): Neumaier. A loop with fastmath would cancel it to nothing."""
    after = total + e
    return after, rest + ((total - after) + e if abs(total) >= abs(e) else (e - after) + total)
