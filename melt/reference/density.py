r"""Density. Melting paper eq (1), in the form that holds for unequal volumes (spec 2.2).

.. math:: \rho_i = \frac{m_i}{V_i} \sum_j V_j W_{ij}

with j over liquid (itself included), solid and wall particles. V is ``volume``: V_min for
liquid in the paper's number-density form (then m_i / V_min sum V_j W = m_i sum_j W +
m_i sum_k phi_k W, eq 1), phi_k V_min for solids and walls.
"""

import numpy as np

from melt.reference._pairs import W, separations


def density(
    position, phase, mass, volume, rest_volume, neighbour_count, neighbour_index,
    smoothing, fluid, density,
):
    """Write the density of liquid particles; others get mass / rest_volume.

    Reads: position (3, n) [m], phase (n,), mass (n,) [kg], volume (n,) and rest_volume (n,)
        [m^3]; the neighbour list is not used (all pairs).
    Writes: density (n,) [kg/m^3]; 0 for inactive slots.
    """
    _, r = separations(position)
    V = np.where(phase == 5, 0.0, volume.astype(np.float64))
    total = (V[None, :] * W(r, smoothing)).sum(axis=1)
    m = mass.astype(np.float64)
    rho = fluid.density_factor * m / np.where(V > 0, V, 1) * total  # eq (1)
    rest = m / np.where(rest_volume > 0, rest_volume, 1)
    density[:] = np.where(phase == 0, rho, np.where(phase == 5, 0.0, rest))
