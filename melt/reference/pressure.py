"""Equation of state. Melting spec 2.3."""

import numpy as np

from melt.reference._pairs import W, separations


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


def boundary_pressure(
    position, phase, density, pressure, neighbour_count, neighbour_index, smoothing, fluid, boundary_pressure,
):
    r"""Write the pressure of the liquid around each liquid particle, brought to its place; others 0.

    .. math::
        P_i = \bar p_i + \rho_i g \cdot \frac{\sum_j x_{ij} W_{ij}}{\sum_j W_{ij}}, \quad
        \bar p_i = \frac{\sum_j p_j W_{ij}}{\sum_j W_{ij}}

    over liquid j, i itself included; the hydrostatic second term stays within :math:`\pm|\bar p_i|`.
    Liquid without a solid or wall in its support keeps P_i = p_i: nobody asks for it.
    Solids and walls carry P_i (see `melt.reference.force`).

    Reads: position (3, n) [m], phase (n,), density (n,) [kg/m^3], pressure (n,) [Pa]; all pairs.
    Writes: boundary_pressure (n,) [Pa].
    """
    x_ij, r = separations(position)
    liquid = phase == 0
    rho, p = np.asarray(density, dtype=np.float64), np.asarray(pressure, dtype=np.float64)
    beside = ((r < float(smoothing.support)) & ((phase == 1) | (phase == 2))[None, :]).any(axis=1)
    w = np.where(liquid[:, None] & liquid[None, :], W(r, smoothing), 0.0)
    total = np.where(liquid, w.sum(axis=1), 1.0)
    mean = (w @ p) / total
    g = np.array([fluid.gravity_x, fluid.gravity_y, fluid.gravity_z], dtype=np.float64)
    head = rho * np.tensordot(g, (x_ij * w).sum(axis=2), axes=1) / total
    around = mean + np.clip(head, -np.abs(mean), np.abs(mean))
    boundary_pressure[:] = np.where(liquid, np.where(beside, around, p), 0.0)
