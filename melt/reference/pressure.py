"""Equation of state. Melting spec 2.3."""

import numpy as np


def tait_pressure(phase, mass, volume, density, fluid, pressure):
    """Write p = B((rho/rho0)^7 - 1) of liquid particles, B = rho0 cs^2/7, rho0 = m/V; others 0.

    With ``fluid.clamp`` the pressure is never negative.
    Reads: phase (n,), mass (n,) [kg], volume (n,) [m^3], density (n,) [kg/m^3].
    Writes: pressure (n,) [Pa].
    """
    liquid = phase == 0
    rho0 = mass[liquid].astype(np.float64) / volume[liquid]
    B = rho0 * float(fluid.sound_speed) ** 2 / 7
    p = B * ((density[liquid] / rho0) ** 7 - 1)
    if fluid.clamp == 1:
        p = np.where(p < 0, 0.0, p)
    pressure[:] = 0.0
    pressure[liquid] = p


def wall_pressure(phase, pressure, blend, wall_pressure):
    """Relax the mean pressure of liquid particles: P += blend (p - P), blend = dt/tau; others 0.

    Walls near a liquid particle carry this mean (see `melt.reference.force`).
    Reads: phase (n,), pressure (n,) [Pa], ``blend`` in [0, 1]. Writes: wall_pressure (n,) [Pa].
    """
    mean = wall_pressure.astype(np.float64)
    wall_pressure[:] = np.where(phase == 0, mean + blend * (pressure - mean), 0.0)
