r"""What the density solve and contact do to the particles of solids. Boiling spec 2.1; ADR 20.

To liquid a solid is a wall: it pushes and never pulls (`melt.reference.pbf`). The solid gets the opposite of each push,

.. math::
    \Delta p_i = \frac{\omega}{m_i} \sum_{j\,liquid}
        \big( \min(\lambda_j, 0) V_i + s_{ij} \tfrac{V_i + V_j}{2} \big) \nabla W_{ij}

and is pushed out of walls and other bodies closer than a spacing d, by half of what is missing and the less the heavier it is:

.. math:: \Delta p_i \mathrel{+}= \frac{w_i}{w_i + w_j} \frac{d - r}{2} \frac{x_{ij}}{r}, \quad w = 1/m, \text{ of walls } 0

so that the momentum of liquid and solids together stays.
"""

import numpy as np

from melt.reference._pbf import tables


def solid_correction(
    position, phase, mass, volume, multiplier, support_radius, kernel_scale, site, site_component, neighbour_count,
    neighbour_index, solid_index, solid_count, pbf, correction,
):
    """Write the position corrections of the listed particles of solids. Particles of one body do not touch each other.

    Reads: position (3, n) [m], phase (n,), mass (n,) [kg], volume (n,) [m^3], multiplier (n,) [kg m^2], site (n,),
        site_component (s,), solid_index (n,) of which the first solid_count[0] count; neighbour lists.
    Writes: correction (3, n) [m]; others keep theirs.
    """
    x, r, R, _, grad = tables(position, support_radius, kernel_scale, pbf)
    V, lam, m = (a.astype(np.float64) for a in (volume, multiplier, mass))
    d = float(pbf.spacing)
    for i in solid_index[: int(solid_count[0])]:
        total = np.zeros(3)
        for j in neighbour_index[i, : neighbour_count[i]]:
            if phase[j] == 0:
                s = -float(pbf.push) * (max(1 - (r[i, j] / R[i, j]) ** 2, 0.0) * float(pbf.push_scale)) ** 12
                bracket = min(lam[j], 0.0) * V[i] + s * (V[i] + V[j]) / 2
                total += float(pbf.omega) / m[i] * bracket * grad[:, i, j]
            apart = phase[j] == 1 and site_component[site[i]] != site_component[site[j]]
            if (apart or phase[j] == 2) and 1e-9 * d < r[i, j] < d:
                share = 1.0 if phase[j] == 2 else m[j] / (m[i] + m[j])
                total += share * 0.5 * (d - r[i, j]) / r[i, j] * x[:, i, j]
        correction[:, i] = total
