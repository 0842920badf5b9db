r"""Mass and velocity of nodes from APIC particles. Slime spec 2.1, (1.3), (1.4), 2.6.

.. math::
    m_I = \sum_p w_{Ip} m_p, \quad
    v_I = \frac{1}{m_I} \sum_p w_{Ip} m_p \left[ v_p + C_p (x_I - \bar x_p) \right]

keeps mass, momentum and, with B_p = C_p D_p, the angular momentum
:math:`\sum_p m_p (\bar x_p \times v_p + \epsilon : B_p)`. About x_p instead of the centroid it would keep
neither momentum.

The volume of a node, by which it counts in densities and forces, is bounded (ADR 21): a node that stands alone among many
APIC particles gets the mass of all, and is by itself as dense as liquid; no neighbour that it pushes away would help.
"""

import numpy as np

from melt.reference._apic import nine, pairs, shares, wrapped
from melt.reference._pairs import W
from melt.reference._shares import rows


def apic_to_nodes(
    position, phase, apic_start, apic_position, apic_velocity, apic_affine, apic_mass, apic_weight, apic_centre,
    grid, period, apic, mass, volume, velocity, node_state,
):
    """Write the state of nodes (liquid); a node without mass keeps its velocity, other particles theirs.

    Reads: position (3, n) [m], phase (n,), apic_position (3, P) [m], apic_velocity (3, P) [m/s] at the centroid,
        apic_affine (9, P) [1/s], apic_mass (P,) [kg], apic_weight (P,) [1/m^3], 0: takes no part,
        apic_centre (3, P) [m].
    Writes: mass (n,) [kg], volume (n,) [m^3] = m/rho0, apic.most at most, velocity (3, n) [m/s] of liquid; node_state (n,):
        1 for a node of less mass than apic.massless, whose mass and volume are 0.
    """
    d, weights = pairs(position, phase, apic_position, period, apic)
    m_p, v_p = apic_mass.astype(np.float64), apic_velocity.astype(np.float64)
    share = shares(weights, apic_weight) * m_p
    C = nine(apic_affine) if apic.affine else np.zeros((len(m_p), 3, 3))
    away = d - apic_centre.astype(np.float64)[:, None, :]
    m = share.sum(axis=1)  # (1.3)
    momentum = np.einsum("ip,aip->ai", share, v_p[:, None, :] + np.einsum("pab,bip->aip", C, away))  # (1.4)
    liquid = phase == 0
    none = liquid & (m < float(apic.massless))
    some = liquid & ~none
    mass[:] = np.where(some, m, np.where(none, 0.0, mass))
    volume[:] = np.where(some, np.minimum(m / float(apic.rest_density), float(apic.most)), np.where(none, 0.0, volume))
    velocity[:] = np.where(some, momentum / np.where(some, m, 1.0), velocity)
    node_state[:] = none


def massless_velocity(position, phase, node_state, volume, neighbour_count, neighbour_index, smoothing, period, velocity):
    """Write the velocity of nodes without mass: the mean of their liquid neighbours with mass, weighted by V_j W_ij.

    Reads: position (3, n) [m], phase (n,), node_state (n,), volume (n,) [m^3], velocity (3, n) [m/s], the neighbour list.
    Writes: velocity (3, n) [m/s] where node_state is 1; unchanged where no such neighbour is near.
    """
    x, V, v = position.astype(np.float64), volume.astype(np.float64), velocity.astype(np.float64)
    for i, near in rows(neighbour_count, neighbour_index):
        if node_state[i] != 1:
            continue
        near = near[(phase[near] == 0) & (node_state[near] == 0) & (V[near] > 0)]
        r = np.sqrt((wrapped(x[:, i, None] - x[:, near], period) ** 2).sum(axis=0))
        share = V[near] * W(r, smoothing)
        if share.sum() > 0:
            velocity[:, i] = (v[:, near] * share).sum(axis=1) / share.sum()
