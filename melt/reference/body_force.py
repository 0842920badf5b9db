"""Forces that are off by default: buoyancy, ambient drag, cohesion. Melting spec 2.3, 8."""

import numpy as np

from melt.reference._pairs import W, separations


def buoyancy(phase, mass, temperature, fluid, force):
    """Add the Boussinesq force F = -m g beta_T (T - T_ref) to liquid particles.

    Reads: phase (n,), mass (n,) [kg], temperature (n,) [degC]. Writes: adds to force (3, n) [N].
    """
    g = np.array([[fluid.gravity_x], [fluid.gravity_y], [fluid.gravity_z]], dtype=np.float64)
    excess = np.asarray(temperature, dtype=np.float64) - float(fluid.reference_temperature)
    F = -g * mass.astype(np.float64) * float(fluid.expansion) * excess
    force[:, phase == 0] += F[:, phase == 0]


def drag(phase, mass, velocity, fluid, force):
    """Add the ambient drag F = -c m v to liquid particles, c = ``fluid.drag`` [1/s].

    Reads: phase (n,), mass (n,) [kg], velocity (3, n) [m/s]. Writes: adds to force (3, n) [N].
    """
    F = -float(fluid.drag) * mass.astype(np.float64) * velocity.astype(np.float64)
    force[:, phase == 0] += F[:, phase == 0]


def surface_tension(position, phase, mass, neighbour_count, neighbour_index, smoothing, fluid, force):
    r"""Add cohesion between liquid particles (after Becker & Teschner 2007).

    .. math:: F_i = -\kappa \, m_i \sum_j m_j W_{ij} x_{ij}

    Written with m_i m_j, so that unequal masses conserve momentum too; it cancels inside a
    uniform liquid and pulls its surface inwards.
    Reads: position (3, n) [m], phase (n,), mass (n,) [kg]. Writes: adds to force (3, n) [N].
    """
    x_ij, r = separations(position)
    m = np.where(phase == 0, mass.astype(np.float64), 0.0)
    F = -float(fluid.surface_tension) * (m[:, None] * m[None, :] * W(r, smoothing) * x_ij).sum(axis=2)
    force[:, phase == 0] += F[:, phase == 0]
