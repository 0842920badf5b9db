r"""Heat of the liquid: conduction between particles, heater, surface, latent store. Boiling eqs (10), (11), spec 2.3, 3.

.. math::
    \theta_i &= \tfrac16 \sum_j V_j r_{ij}^2 \nabla^2 W_3(r_{ij}, R_{ij}), \quad
        L_{ij} = \nabla^2 W_3 \frac{2}{\theta_i + \theta_j} \\
    \frac{dT_i}{dt} &= \alpha \sum_j V_j (T_j - T_i) L_{ij} \quad (11), \qquad
    \frac{dT_i}{dt} = \alpha \sum_j \frac{m_j}{\rho_j} (T_j - T_i) \nabla^2 W_3 \quad (10)

with i and j liquid, V = V_0, m_j/rho_j = V_j/(1 + C_j). (11) is symmetric: particles of equal V keep their heat
to rounding. The floor and the surface are insulated without ghosts, but for heater and cooling.
"""

import numpy as np

from melt.reference._pairs import separations
from melt.reference._pbf import pair_supports
from melt.reference._shares import shares


def _liquid(phase, *arrays):
    """Return indices of liquid particles, and their part of arrays whose last axis counts particles."""
    on = np.flatnonzero(phase == 0)
    return on, *(a[..., on].astype(np.float64) if a.shape[-1] else a for a in arrays)


def _laplacian(position, support_radius, pbf):
    """Return r_ij [m] and lap W3 [1/m^5] of all pairs but those of a particle with itself, where it is 0."""
    _, r = separations(position)
    R = pair_supports(position, support_radius, pbf)
    lap = 45 / (np.pi * R**6) * np.maximum(R - r, 0)
    np.fill_diagonal(lap, 0)
    return r, lap


def _weights(position, rest_volume, constraint, support_radius, heat_sum, pbf, boiling):
    """Return the weight of T_j - T_i in lap T of all pairs [1/m^2]."""
    _, lap = _laplacian(position, support_radius, pbf)
    if boiling.corrected == 1:
        both = heat_sum[:, None] + heat_sum[None, :]
        L = np.where((lap == 0) | (both < 1e-6), 0, lap * 2 / np.maximum(both, 1e-6))
        return rest_volume[None, :] * L  # (11)
    return rest_volume[None, :] / (1 + constraint[None, :]) * lap  # (10)


def boil_sums(position, phase, rest_volume, support_radius, neighbour_count, neighbour_index, pbf, heat_sum):
    """Write theta, by which the sums of a particle fall short of the integral they stand for; 0 of others than liquid.

    Reads: position (3, n) [m], phase (n,), rest_volume (n,) [m^3], support_radius (n,) [m] (effect precision
        only); all pairs. Writes: heat_sum (n,) [1].
    """
    on, x, V, R = _liquid(phase, position, rest_volume, support_radius)
    r, lap = _laplacian(x, R, pbf)
    heat_sum[:] = 0
    heat_sum[on] = (V * r**2 * lap).sum(axis=1) / 6


def boil_rate(
    position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index, pbf, boiling,
    heat_rate,
):
    """Write the largest alpha sum_j V_j L_ij of the liquid in each of 64 pieces of the particles; NaN as infinity.

    An explicit step dt keeps temperatures within their range if dt times the largest is at most 1.

    Reads: as `boil_exchange`. Writes: heat_rate (64,) [1/s].
    """
    on, x, V, C, R, th = _liquid(phase, position, rest_volume, constraint, support_radius, heat_sum)
    rate = np.zeros(len(phase))
    rate[on] = float(boiling.diffusivity) * _weights(x, V, C, R, th, pbf, boiling).sum(axis=1)
    rate = np.where(np.isnan(rate), np.inf, rate)
    heat_rate[:] = [piece.max(initial=0.0) for piece in shares(rate)]


def boil_exchange(
    temperature, position, phase, rest_volume, constraint, support_radius, heat_sum, neighbour_count, neighbour_index,
    pbf, boiling, dt, temperature_next,
):
    """Write temperatures after an explicit Euler step of conduction; others than liquid keep theirs.

    Reads: temperature (n,) [degC], position (3, n) [m], phase (n,), rest_volume (n,) [m^3], constraint (n,)
        (eq (10) only), support_radius (n,) [m] (effect precision only), heat_sum (n,) (eq (11) only); all pairs.
    Writes: temperature_next (n,) [degC].
    """
    on, T, x, V, C, R, th = _liquid(phase, temperature, position, rest_volume, constraint, support_radius, heat_sum)
    w = _weights(x, V, C, R, th, pbf, boiling)
    temperature_next[:] = temperature
    temperature_next[on] = T + float(dt) * float(boiling.diffusivity) * (w * (T[None, :] - T[:, None])).sum(axis=1)


def _approach(touched, mass, boiling, target, share, temperature):
    """Move the temperature of some particles towards a target; return the heat that each one gained [J]."""
    before = temperature.astype(np.float64)
    after = before + float(share) * (float(target) - before)
    temperature[touched] = (after if share < 1 else np.full_like(after, target))[touched]
    return mass.astype(np.float64) * float(boiling.specific_heat) * (temperature.astype(np.float64) - before)


def boil_heater(position, phase, mass, bubbles, boiling, target, share, temperature, heater_heat):
    """Heat liquid that touches the heated part of the floor: T += share (target - T).

    Contact is below ``boiling.contact``; share is 1 - exp(-k_h dt), or 1 for a fixed temperature.

    Reads: position (3, n) [m], phase (n,), mass (n,) [kg]. Writes: temperature (n,) [degC], heater_heat (64,)
        [J]: what came in, from the temperatures as they are stored, in 64 pieces of the particles.
    """
    x, y, z = position.astype(np.float64)
    over = (x >= boiling.heater_lower_x) & (x <= boiling.heater_upper_x)
    over &= (y >= boiling.heater_lower_y) & (y <= boiling.heater_upper_y)
    touched = (phase == 0) & over & (z - float(bubbles.floor) < boiling.contact)
    heat = _approach(touched, mass, boiling, target, share, temperature)
    heater_heat[:] = [piece.sum() for piece in shares(heat)]


def boil_cooling(position, phase, mass, bubbles, boiling, target, share, height, temperature, lost_heat):
    """Cool liquid that is at least ``height`` [m] above the floor, as `boil_heater` heats it.

    Reads: as `boil_heater`. Writes: temperature (n,) [degC], lost_heat (64,) [J], positive when heat leaves.
    """
    touched = (phase == 0) & (position[2].astype(np.float64) - float(bubbles.floor) >= height)
    heat = _approach(touched, mass, boiling, target, share, temperature)
    lost_heat[:] = [-piece.sum() for piece in shares(heat)]


def boil_store(phase, boiling, temperature, latent_store):
    """Put heat of liquid above the boiling point into its latent store: it stays at the boiling point.

    Reads: phase (n,). Writes: temperature (n,) [degC], latent_store (n,) [J/kg].
    """
    T = temperature.astype(np.float64)
    hot = (phase == 0) & (T > boiling.boiling_point)
    excess = float(boiling.specific_heat) * (T - float(boiling.boiling_point))
    latent_store[hot] = (latent_store.astype(np.float64) + excess)[hot]
    temperature[hot] = boiling.boiling_point


def boil_content(phase, mass, temperature, latent_store, boiling, boil_content):
    """Write the heat of the liquid, sum of m (c_p T + latent store), in 64 pieces of the particles.

    Reads: phase (n,), mass (n,) [kg], temperature (n,) [degC], latent_store (n,) [J/kg].
    Writes: boil_content (64,) [J].
    """
    T, store, m = temperature.astype(np.float64), latent_store.astype(np.float64), mass.astype(np.float64)
    heat = np.where(phase == 0, m * (float(boiling.specific_heat) * T + store), 0.0)
    boil_content[:] = [piece.sum() for piece in shares(heat)]
