r"""Oldroyd-B stress on APIC particles. Slime spec 2.13.

.. math::
    F = (I - \tfrac{\Delta t}{2} C)^{-1} (I + \tfrac{\Delta t}{2} C), \quad
    b' = \frac{F b F^T + (\Delta t/\lambda) I}{1 + \Delta t/\lambda}

keeps b positive for every time step. The force

.. math::
    f_I = -\sum_p V_p w_{Ip} \tau_p D_p^+ (x_I - \bar x_p), \quad \tau_p = \frac{G (b - I)}{1 + \Delta t/\lambda}

has neither a sum nor a torque: :math:`\sum_I w_{Ip} (x_I - \bar x_p) = 0` and tau is symmetric (a torque is left only
where the pseudo-inverse drops directions). What tau lacks of the stress at the end of the step belongs to the
viscosity, which acts implicitly: mu_e = G lambda dt/(lambda + dt).
"""

import numpy as np

from melt.reference._apic import full, nine, pairs, shares, six_of


def apic_strain(apic_phase, apic_affine, elastic, dt, apic_strain):
    """Write the conformation tensor after dt.

    Reads: apic_phase (P,), apic_affine (9, P) [1/s]. Writes: apic_strain (6, P) of active APIC particles.
    """
    one, half, rate = np.eye(3), 0.5 * float(dt), float(dt) / float(elastic.relaxation)
    C, b = nine(apic_affine), full(apic_strain.astype(np.float64))
    for p in np.flatnonzero(apic_phase == 0):
        F = np.linalg.solve(one - half * C[p], one + half * C[p])
        b[p] = (F @ b[p] @ F.T + rate * one) / (1 + rate)
        b[p] = (b[p] + b[p].T) / 2
    apic_strain[:] = six_of(b)


def elastic_force(
    position, phase, apic_start, apic_position, apic_mass, apic_weight, apic_centre, apic_inverse, apic_strain,
    grid, period, apic, elastic, dt, force,
):
    """Add the elastic force to nodes (liquid); others keep theirs.

    Reads: position (3, n) [m], phase (n,), apic_position (3, P) [m], apic_mass (P,) [kg], apic_weight (P,) [1/m^3],
        apic_centre (3, P) [m], apic_inverse (6, P) [1/m^2], apic_strain (6, P) at the start of the step.
    Writes: force (3, n) [N].
    """
    d, weights = pairs(position, phase, apic_position, period, apic)
    w = shares(weights, apic_weight)
    away = d - apic_centre.astype(np.float64)[:, None, :]
    V = apic_mass.astype(np.float64) / float(apic.rest_density)
    tau = float(elastic.modulus) * (full(apic_strain.astype(np.float64)) - np.eye(3)) / (1 + float(dt) / float(elastic.relaxation))
    pull = V[:, None, None] * tau @ full(apic_inverse.astype(np.float64))
    force[:] = force - np.einsum("ip,pab,bip->ai", w, pull, away)
