r"""Weights of the transfers between APIC particles and nodes. Slime spec 2.1, 2.6.

.. math::
    S_p = \sum_I W(|x_I - x_p|, h_t), \quad w_{Ip} = W / S_p, \quad
    \bar x_p = \sum_I w_{Ip} x_I, \quad D_p = \sum_I w_{Ip} (x_I - \bar x_p)(x_I - \bar x_p)^T

Nodes are the liquid particles, held ones too. W is not weighted by V_I: that would feed the mass of a node
back into itself. The weights of particles do not reproduce linear fields as those of a lattice do
(:math:`\sum_I w_{Ip} (x_I - x_p) \ne 0`): all transfers therefore are about the centroid, about which they do.
"""

import numpy as np

from melt.reference._apic import pairs, six_of


def apic_weights(
    position, phase, cell_start, apic_phase, apic_position, grid, period, apic,
    apic_weight, apic_centre, apic_inverse, apic_state,
):
    """Write what the transfers of each APIC particle need.

    An orphan has S_p below apic.orphan; its weight, centre and inverse are 0, as those of inactive ones.
    The pseudo-inverse leaves out directions in which the nodes do not spread: a thin sheet says nothing
    about the velocity gradient across it.

    Reads: position (3, n) [m], phase (n,), apic_phase (P,), apic_position (3, P) [m].
    Writes: apic_weight (P,) S_p [1/m^3]; apic_centre (3, P) centroid minus apic_position [m];
        apic_inverse (6, P) D_p^+ [1/m^2], eigenvalues of D_p below apic.rank dropped; apic_state (P,).
    """
    d, weights = pairs(position, phase, apic_position, period, apic)
    S = weights.sum(axis=0)
    active = apic_phase == 0
    orphan = active & (S < float(apic.orphan))
    found = active & ~orphan
    w = np.where(found, weights / np.where(found, S, 1.0), 0.0)
    centre = np.einsum("ip,aip->ap", w, d)
    e = d - centre[:, None, :]
    D = np.einsum("ip,aip,bip->pab", w, e, e)
    inverse = np.zeros_like(D)
    for p in np.flatnonzero(found):
        values, vectors = np.linalg.eigh(D[p])
        kept = values >= float(apic.rank)
        inverse[p] = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    apic_weight[:] = np.where(found, S, 0.0)
    apic_centre[:] = centre
    apic_inverse[:] = six_of(inverse)
    apic_state[:] = orphan
