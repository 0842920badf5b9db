r"""Motion of APIC particles from nodes. Slime spec 2.3, 2.4, 2.6.

.. math::
    v_p = \sum_I w_{Ip} v_I, \quad B_p = \sum_I w_{Ip} v_I (x_I - \bar x_p)^T, \quad C_p = B_p D_p^+

    x_p' = x_p + \Delta t \left[ v_p + C_p (x_p - \bar x_p) \right]

The patent's rule for positions, :math:`x_p' = \sum_I w_{Ip} x_I'`, puts a particle at the centroid of its nodes even
if nothing moves: the particles of a fluid at rest gather at its nodes within tens of steps. It equals the increment
where weights reproduce linear fields.
"""

import numpy as np

from melt.reference._apic import full, nine, pairs, shares
from melt.reference._shares import shares as pieces


def nodes_to_apic(
    position, phase, cell_start, velocity, velocity_kept, apic_phase, apic_position, apic_weight, apic_centre, apic_inverse,
    grid, period, apic, fluid, dt, apic_velocity, apic_affine,
):
    """Write the velocity and affine velocity of APIC particles; an orphan falls freely and keeps its affine velocity.

    With a share of FLIP, gamma: v_p = (1 - gamma) sum w v_I + gamma (v_p + sum w (v_I - v_I^kept)).

    Reads: position (3, n) [m], phase (n,), velocity (3, n) and, with FLIP, velocity_kept (3, n) [m/s], apic_phase (P,),
        apic_position (3, P) [m], apic_weight (P,) [1/m^3], apic_centre (3, P) [m], apic_inverse (6, P) [1/m^2].
    Writes: apic_velocity (3, P) [m/s], apic_affine (9, P) [1/s], those of inactive ones excepted.
    """
    d, weights = pairs(position, phase, apic_position, period, apic)
    w = shares(weights, apic_weight)
    v, v_p, gamma = velocity.astype(np.float64), apic_velocity.astype(np.float64), float(apic.flip)
    away = d - apic_centre.astype(np.float64)[:, None, :]
    mean = np.einsum("ip,ai->ap", w, v)
    if gamma:
        change = v - velocity_kept.astype(np.float64)
        mean = (1 - gamma) * mean + gamma * (v_p + np.einsum("ip,ai->ap", w, change))
    B = np.einsum("ip,ai,bip->pab", w, v, away)
    C = B @ full(apic_inverse.astype(np.float64))
    gravity = np.array([fluid.gravity_x, fluid.gravity_y, fluid.gravity_z], dtype=np.float64)[:, None]
    active = apic_phase == 0
    orphan, near = active & ~(apic_weight > 0), active & (apic_weight > 0)
    apic_velocity[:] = np.where(near, mean, np.where(orphan, v_p + float(dt) * gravity, apic_velocity))
    apic_affine[:] = np.where(near, C.reshape(-1, 9).T, apic_affine)


def apic_move(apic_phase, apic_velocity, apic_affine, apic_weight, apic_centre, period, apic, dt, apic_position):
    """Write positions after dt, within the periodic box; an orphan moves with its own velocity.

    Reads: apic_phase (P,), apic_velocity (3, P) [m/s], apic_affine (9, P) [1/s], apic_weight (P,), apic_centre (3, P) [m].
    Writes: apic_position (3, P) [m] of active ones.
    """
    x, v, centre = (a.astype(np.float64) for a in (apic_position, apic_velocity, apic_centre))
    near = apic_weight > 0
    move = float(dt) * (v - np.where(near, np.einsum("pab,bp->ap", nine(apic_affine), centre), 0.0))
    if apic.literal:
        move = np.where(near, centre, 0.0) + float(dt) * v
    x = x + move
    for a, axis in enumerate("xyz"):
        length, inverse, lower = (float(getattr(period, f"{name}_{axis}")) for name in ("length", "inverse", "lower"))
        x[a] -= length * np.floor((x[a] - lower) * inverse)
    apic_position[:] = np.where(apic_phase == 0, x, apic_position)


def apic_sums(apic_phase, apic_mass, apic_state, apic_sums):
    """Write the number of orphans, their mass [kg] and the number of active APIC particles, in 64 pieces.

    Reads: apic_phase (P,), apic_mass (P,) [kg], apic_state (P,). Writes: apic_sums (3, 64).
    """
    active = apic_phase == 0
    orphan = active & (apic_state == 1)
    for row, values in enumerate((orphan, np.where(orphan, apic_mass.astype(np.float64), 0.0), active)):
        apic_sums[row] = [piece.sum(dtype=np.float64) for piece in pieces(values)]
