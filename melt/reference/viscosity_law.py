r"""Viscosity by temperature and shear rate. Slime spec 2.11.

    \mu(\dot\gamma) = K \dot\gamma^{n-1} + \tau_y (1 - e^{-m \dot\gamma})/\dot\gamma,  K by temperature.
"""

import numpy as np

from melt.reference._shares import rows


def shear_rate(velocity, neighbour_count, neighbour_index, pair_gradient, shear_rate):
    r"""Write the shear rate sqrt(2 D:D), D the symmetric part of L = sum_j (v_j - v_i) g_ij^T.

    Reads: velocity (3, n) [m/s], the lists, pair_gradient (3, n, m) [1/m].
    Writes: shear_rate (n,) [1/s]; 0 without neighbours.
    """
    v = velocity.astype(float)
    for i, near in rows(neighbour_count, neighbour_index):
        g = pair_gradient[:, i, : len(near)].astype(float)
        L = (v[:, near] - v[:, i, None]) @ g.T
        D = (L + L.T) / 2
        shear_rate[i] = np.sqrt(2 * (D * D).sum())


def viscosity(phase, temperature, shear_rate, viscous, viscosity):
    r"""Write the viscosity of liquid, 0 elsewhere.

    law 1: K = mu exp(slope (1/T - 1/T_0)) in kelvin; law 2: K = mu exp(-slope (T - T_0)); else mu. The
    power law takes shear rates below 1e-6/s as that; the whole is capped to [smallest, largest].

    Reads: phase (n,), temperature (n,) [degC] or length 0 (no law), shear_rate (n,) [1/s] or length 0 (Newtonian).
    Writes: viscosity (n,) [Pa s].
    """
    for i in range(len(phase)):
        if phase[i] != 0:
            viscosity[i] = 0
            continue
        mu = float(viscous.mu)
        if len(temperature) and viscous.law in (1, 2):
            T, T0, slope = float(temperature[i]), float(viscous.reference_temperature), float(viscous.slope)
            power = slope * (1 / (T + 273.15) - 1 / (T0 + 273.15)) if viscous.law == 1 else -slope * (T - T0)
            mu *= np.exp(min(power, 700.0))
        if len(shear_rate):
            rate, m, tau = float(shear_rate[i]), float(viscous.yield_rate), float(viscous.yield_stress)
            mu *= max(rate, 1e-6) ** (float(viscous.power) - 1)
            mu += tau * (-np.expm1(-m * rate) / rate if rate > 0 else m)
        viscosity[i] = min(max(mu, float(viscous.smallest)), float(viscous.largest))
