r"""What heat does to velocities. Boiling eq (12), spec 2.4.

.. math::
    \text{rate:} \quad v_i &\leftarrow \bar v + (v_i - \bar v) s_i, \quad
        s_i = 1 + k_T \theta_i\, dt\, \max(0, 1 - |v_i - \bar v|^2 / v_b^2) \\
    \text{literal:} \quad v_i &\leftarrow v_i (1 + k_T \theta_i) \\
    \text{boussinesq:} \quad v_i &\mathrel{+}= -dt\, \beta_T (T_i - \bar T)\, g \\
    \text{viscosity:} \quad c_{ij} &\text{ of (8)} \times \tfrac12 (\mu(T_i) + \mu(T_j)) / \mu(20\,C)

with theta = (T - T_0)/(T_b - T_0) within 0 and 1. Rate is logistic growth towards v_b; the page takes out the
momentum that it brings (`shift_velocity`). Literal, applied in every step, is exponential growth: the clamp of
speeds in the prediction bounds it. Boussinesq brings no net momentum, viscosity none at all.
"""

import numpy as np

from melt.reference._pairs import separations
from melt.reference._pbf import pair_supports
from melt.reference._shares import shares

RATE, LITERAL, BOUSSINESQ = 1, 2, 3  # modes


def _liquid(phase, *arrays):
    """Return indices of liquid particles, and their part of arrays whose last axis counts particles."""
    on = np.flatnonzero(phase == 0)
    return on, *(a[..., on].astype(np.float64) if a.shape[-1] else a for a in arrays)


def liquid_sums(phase, mass, velocity, temperature, liquid_sums):
    """Write sums over the liquid of m, m u, m v, m w and m T, in 64 pieces of the particles.

    Reads: phase (n,), mass (n,) [kg], velocity (3, n) [m/s], temperature (n,) [degC].
    Writes: liquid_sums (5, 64) [kg, kg m/s, kg K].
    """
    m = np.where(phase == 0, mass.astype(np.float64), 0.0)
    for row, values in enumerate((np.ones(len(m)), *velocity, temperature)):
        values = np.where(phase == 0, values.astype(np.float64), 0.0)
        liquid_sums[row] = [piece.sum() for piece in shares(m * values)]


def boost(phase, temperature, fluid, boiling, mean_u, mean_v, mean_w, mean_temperature, dt, velocity):
    """Boost the velocity of liquid by its heat (12), in the mode ``boiling.boost``; others keep theirs.

    Reads: phase (n,), temperature (n,) [degC]; mean velocity [m/s] and temperature [degC] of the liquid by mass.
    Writes: velocity (3, n) [m/s].
    """
    on, T, v = _liquid(phase, temperature, velocity)
    T_0, T_b = float(boiling.start_temperature), float(boiling.boiling_point)
    th = np.clip((T - T_0) / (T_b - T_0), 0, 1) if T_b > T_0 else np.where(T >= T_b, 1.0, 0.0)
    k_T, dt = float(boiling.boost_rate), float(dt)
    if boiling.boost == RATE:
        mean = np.array([[mean_u], [mean_v], [mean_w]], np.float64)
        apart = v - mean
        s = 1 + k_T * th * dt * np.maximum(0, 1 - ((apart / float(boiling.boost_speed)) ** 2).sum(axis=0))
        v = mean + apart * s
    elif boiling.boost == LITERAL:
        v = v * (1 + k_T * th)
    elif boiling.boost == BOUSSINESQ:
        g = np.array([[fluid.gravity_x], [fluid.gravity_y], [fluid.gravity_z]], np.float64)
        v = v - dt * float(boiling.expansion) * (T - float(mean_temperature)) * g
    velocity[:, on] = v


def shift_velocity(phase, mean_u, mean_v, mean_w, velocity):
    """Subtract a velocity [m/s] from that of liquid particles. Reads: phase (n,). Writes: velocity (3, n)."""
    on, v = _liquid(phase, velocity)
    velocity[:, on] = v - np.array([[mean_u], [mean_v], [mean_w]], np.float64)


def _viscosity_ratio(T):
    """Return mu(T)/mu(20 C) of water after Vogel, mu = exp(-3.7188 + 578.919/(T_K - 137.546)) mPa s; T in degC."""
    vogel = 578.919 / (np.maximum(T, 0.0) + 273.15 - 137.546)
    return np.exp(vogel - 578.919 / (293.15 - 137.546))


def boost_xsph(
    position, velocity, phase, mass, volume, temperature, support_radius, neighbour_count, neighbour_index, pbf, dt,
    velocity_next,
):
    """Write velocities blended as in (8), less where the water is hot and thin; exact in momentum.

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), mass (n,) [kg], volume (n,) [m^3],
        temperature (n,) [degC]; all pairs. Writes: velocity_next (3, n) [m/s]; others than liquid keep theirs.
    """
    on, x, v, m, V, T, R_i = _liquid(phase, position, velocity, mass, volume, temperature, support_radius)
    _, r = separations(x)
    R = pair_supports(x, R_i, pbf)
    W1 = 315 / (64 * np.pi * R**3) * np.where(r < R, 1 - (r / R) ** 2, 0.0) ** 3
    mu = _viscosity_ratio(T)
    c = min(0.5, float(pbf.blend) * float(dt)) * (mu[:, None] + mu[None, :]) / 2
    weight = c * 2 * m[None, :] / (m[:, None] + m[None, :]) * (V[:, None] + V[None, :]) / 2 * W1
    velocity_next[:] = velocity
    velocity_next[:, on] = v + (weight * (v[:, None, :] - v[:, :, None])).sum(axis=2)
