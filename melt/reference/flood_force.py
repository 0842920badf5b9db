r"""Forces between columns of water, per unit mass. Flood spec 2, E6, E7, E10, E16.

.. math::
    a_i = -\sum_j V_j \big[ c_i \nabla W(h_i) + c_j \nabla W(h_j) \big]
          - \sum_j V_j \Pi_{ij} \nabla\bar W + \sum_j \frac{V_j}{\bar d_{ij}}
            \frac{2 \nu |\nabla\bar W|}{r + 0.01 \bar l} (v_j - v_i) - g \nabla b_i

with c_i = g/(2 Omega_i) (variational: minus the derivative of E = sum V (g d/2 + g b) divided by V_i),
g/2 (symmetric) or, of the paper's linear equation of state, both c_i and c_j = (P_i/d_i^2 + P_j/d_j^2)/2.
rho_w cancels. V_i V_j times each bracket is antisymmetric (l, d and c of E10 are means of both columns; the spec
has l_i), so pairs conserve momentum. E7 has a constant kinematic viscosity: nu of the paper at the depth d_ref.
"""

import numpy as np

from melt.reference._flood_forces import dW_over_r, separated, specific_pressure, stabilisation


def flood_force(
    id, position, velocity, phase, rest_volume, depth, support_radius, support_factor, bed_slope, neighbour_count,
    neighbour_index, flood, acceleration,
):
    """Write the acceleration of liquid columns; 0 for others.

    Reads: id (n,), position (3, n) [m], velocity (3, n) [m/s], phase (n,), rest_volume (n,) [m^3], depth (n,) [m],
        support_radius (n,) [m], support_factor (n,) [1], bed_slope (2, n) [1]; the list is not used (all pairs).
    Writes: acceleration (2, n) [m/s^2].
    """
    wet = phase == 0
    acceleration[:] = 0.0
    h, d, V = (a[wet].astype(np.float64) for a in (support_radius, depth, rest_volume))
    x_ij, r = separated(id[wet], position[:, wet], h)
    v = velocity[:2, wet].astype(np.float64)
    v_ij = v[:, :, None] - v[:, None, :]
    F_i, F_j = dW_over_r(r, h[:, None], flood), dW_over_r(r, h[None, :], flood)
    s = specific_pressure(d, flood)
    if flood.form == 0:
        Omega = support_factor[wet].astype(np.float64)
        pressure = F_i * (s / Omega)[:, None] + F_j * (s / Omega)[None, :]  # E6
    else:
        pressure = 0.5 * (F_i + F_j) * (s[:, None] + s[None, :])
    F = 0.5 * (F_i + F_j)
    Pi, drag = stabilisation(x_ij, r, v_ij, h, d, F, flood)
    a = -((pressure + Pi * F) * V[None, :] * x_ij).sum(axis=2) - (drag * V[None, :] * v_ij).sum(axis=2)
    acceleration[:, wet] = a - float(flood.gravity) * bed_slope[:, wet].astype(np.float64)


def wall_force(
    position, phase, support_radius, depth, bed, support_factor, wall_count, wall_index, boundary_position,
    boundary_area, flood, acceleration,
):
    """Add what walls do to the acceleration of liquid columns.

    Mirrored stage: a wall particle carries d_ib = max(0, eta_i - z_b) with the pressure of the column itself,
    a_i -= sum_b 2 c_i d_ib V_b grad W(h_i), which is E16 for the hydrostatic forms. Else (paper) the mass
    rho_0 V_b of the reference depth, a_i -= sum_b c_i d_ref V_b grad W(h_i). No viscosity.

    Mirrored walls carry the stage of the column itself, whatever it is beside: a surface that slopes along a wall would push
    by 1 - M_tt of what it should, M = sum_b V_b grad W (x) (x_b - x_i), t along the wall (across G = sum_b V_b grad W).
    The acceleration along t is therefore divided by it; a straight wall has M_tt = sum_b V_b W, one half at most.
    (Ritter in a strip 20 columns wide: the row at the wall was 10 % too slow, then 2 % too fast.) Midway between two walls
    G cancels and its direction means nothing: the addition is weighted with (l |G|)^2/((l |G|)^2 + 0.001).

    Reads: position (3, n) [m], phase (n,), depth, bed, support_radius (n,) [m], support_factor (n,) [1],
        boundary_position (3, b) [m], boundary_area (b,) [m^2]; the list is not used (all pairs).
    Writes: acceleration (2, n) [m/s^2].
    """
    wet = phase == 0
    h, d, b = (a[wet].astype(np.float64) for a in (support_radius, depth, bed))
    x_b = boundary_position.astype(np.float64)
    x_ib = position[:2, wet].astype(np.float64)[:, :, None] - x_b[:2, None, :]
    F = dW_over_r(np.sqrt((x_ib**2).sum(axis=0)), h[:, None], flood)
    c = specific_pressure(d, flood)
    if flood.form == 0:
        c = c / support_factor[wet].astype(np.float64)
    stage = np.maximum(0.0, (b + d)[:, None] - x_b[2][None, :])
    carried = 2 * stage if flood.wall_mirror == 1 else np.full_like(stage, float(flood.reference_depth))
    per_pair = c[:, None] * carried * boundary_area.astype(np.float64)[None, :] * F
    a = acceleration[:, wet].astype(np.float64) - (per_pair * x_ib).sum(axis=2)  # E16
    if flood.wall_mirror == 1:
        VF = np.where(stage > 0, boundary_area.astype(np.float64)[None, :] * F, 0.0)
        G = (VF * x_ib).sum(axis=2)
        beside = np.linalg.norm(G, axis=0) > 0
        t = np.array([-G[1], G[0]]) / np.where(beside, np.linalg.norm(G, axis=0), 1.0)
        M_tt = -(VF * (t[:, :, None] * x_ib).sum(axis=0) ** 2).sum(axis=1)
        sided = (0.5 * h) ** 2 * (G**2).sum(axis=0)
        fade = sided / (sided + 0.001)
        a += np.where(beside, fade * (1 / np.maximum(1 - M_tt, 0.5) - 1) * (t * a).sum(axis=0), 0.0) * t
    acceleration[:, wet] = a
