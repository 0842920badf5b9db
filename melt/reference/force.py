r"""Forces of the weakly compressible liquid and their reaction on solids. Melting spec 2.3, 2.4.

For liquid i, with x_ij = x_i - x_j, v_ij = v_i - v_j, hs = h/2, rho0_i = m_i/V_i:

.. math::
    F_{i \leftarrow j} &= -V_i V_j \big( p_i (\rho^0_i/\rho_i)^2 + p_j (\rho^0_j/\rho_j)^2 \big) \nabla W_{ij}
        + m_i m_j \nu_{ij} \frac{v_{ij} \cdot x_{ij}}{r^2 + 0.01 h_s^2} \nabla W_{ij} \\
    F_{i \leftarrow k} &= -V_i V_k \big( p_i (\rho^0_i/\rho_i)^2 + \beta p_k \big) \nabla W_{ik}
        + m_i \rho^0_i V_k \nu_{ik} \frac{v_{ik} \cdot x_{ik}}{r^2 + 0.01 h_s^2} \nabla W_{ik}

for liquid j, and for k solid or wall (2', 3'); V_k = phi_k V_min. The viscous terms act only on
pairs that approach (v.x < 0): nu_ij = 2 alpha hs cs/(rho_i + rho_j), nu_ik = sigma hs cs/(2 rho_i).

The boundary's pressure is that of a liquid at rest there, p_k = P_i - rho_i g . x_ik within 0 and
2 P_i: (2') with a mean P_i of the liquid's pressure around i (`melt.reference.pressure`) in place of
p_i, and with the hydrostatic head.
"""

import numpy as np

from melt.reference._pairs import gradW, separations


def _pair_forces(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, smoothing, fluid
):
    """Return F (3, n, n) [N], F[:, i, j] on liquid i from j (any phase); 0 for other i."""
    x_ij, r = separations(position)
    v = np.asarray(velocity, dtype=np.float64)
    v_ij = v[:, :, None] - v[:, None, :]
    grad = gradW(x_ij, r, smoothing)
    liquid, boundary = phase == 0, (phase == 1) | (phase == 2)
    m, V, rho, p = (np.asarray(a, dtype=np.float64) for a in (mass, volume, density, pressure))
    rho = np.where(rho > 0, rho, 1.0)
    rho0 = np.where(liquid, m / np.where(V > 0, V, 1.0), 0.0)
    s = np.where(liquid, p * (rho0 / rho) ** 2, 0.0)
    to_liquid = liquid[:, None] & liquid[None, :] & ~np.eye(len(phase), dtype=bool)
    to_boundary = liquid[:, None] & boundary[None, :]
    VV = V[:, None] * V[None, :]

    # pressure: symmetric form between liquids; (2') against boundaries, with hydrostatic head
    push = np.where(to_liquid, -VV * (s[:, None] + s[None, :]), 0.0)
    g_x = (_gravity(fluid)[:, :, None] * x_ij).sum(axis=0)
    P = np.asarray(boundary_pressure, dtype=np.float64)[:, None]
    p_k = P - np.clip(rho[:, None] * g_x, -np.abs(P), np.abs(P))
    push += np.where(to_boundary, -VV * (s[:, None] + float(fluid.mirror) * p_k), 0.0)

    # artificial viscosity between liquids; friction (3') against boundaries
    hs, cs = float(smoothing.support) / 2, float(fluid.sound_speed)
    sigma = np.where(phase == 1, float(fluid.solid_friction), float(fluid.wall_friction))
    nu_liquid = 2 * float(fluid.alpha) * hs * cs / (rho[:, None] + rho[None, :])
    nu_boundary = sigma[None, :] * hs * cs / (2 * rho[:, None])
    v_x = (v_ij * x_ij).sum(axis=0)
    closing = np.where(v_x < 0, v_x, 0.0) / (r**2 + 0.01 * hs**2)
    damp = np.where(to_liquid, m[:, None] * m[None, :] * nu_liquid * closing, 0.0)
    damp += np.where(to_boundary, (m * rho0)[:, None] * V[None, :] * nu_boundary * closing, 0.0)
    return (push + damp) * grad


def _gravity(fluid):
    return np.array([[fluid.gravity_x], [fluid.gravity_y], [fluid.gravity_z]], dtype=np.float64)


def fluid_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    """Write the force on liquid particles: pressure, viscosity, gravity; 0 for all but solids.

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), mass (n,) [kg], volume (n,)
        [m^3], density (n,) [kg/m^3], pressure and boundary_pressure (n,) [Pa]; all pairs.
    Writes: force (3, n) [N]; solids keep theirs.
    """
    F = _pair_forces(position, velocity, phase, mass, volume, density, pressure, boundary_pressure, smoothing, fluid)
    total = F.sum(axis=2) + np.asarray(mass, dtype=np.float64) * _gravity(fluid)
    force[:, phase != 1] = np.where(phase == 0, total, 0.0)[:, phase != 1]


def reaction_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    """Write the force on solid particles: gravity, and minus what they do to liquid (Newton 3).

    Reads: as `fluid_force`. Writes: force (3, n) [N] of solids; all others keep theirs.
    """
    F = _pair_forces(position, velocity, phase, mass, volume, density, pressure, boundary_pressure, smoothing, fluid)
    total = -F.sum(axis=1) + np.asarray(mass, dtype=np.float64) * _gravity(fluid)
    force[:, phase == 1] = total[:, phase == 1]
