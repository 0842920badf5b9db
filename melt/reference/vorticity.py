r"""Velocity filters of the position based fluid: vorticity confinement and XSPH. Boiling eqs (7), (8), spec 2.2.

.. math::
    \omega_i &= \sum_j V_j (v_j - v_i) \times \nabla_{p_j} W_{ij}, \quad \eta_i = \sum_j V_j (|\omega_j| - |\omega_i|) \nabla W_{ij} \\
    v_i &\mathrel{+}= dt\, \epsilon_v \frac{\eta_i}{|\eta_i| + 10^{-9}/(R\,dt)} \times \omega_i \\
    v_i &\mathrel{+}= c \sum_j \frac{2 m_j}{m_i + m_j} \frac{V_i + V_j}{2} W^{poly6}_{ij} (v_j - v_i), \quad c = \min(0.5, \gamma\, dt)

with i and j liquid; in XSPH one of them may be solid: water takes ice along, and ice water. XSPH takes the plain poly6: it is a
filter, whose strength gamma sets.
"""

import numpy as np

from melt.reference._pairs import separations
from melt.reference._pbf import pair_supports, tables


def _liquid(phase, *arrays):
    """Return indices of liquid particles, and their part of arrays whose last axis counts particles."""
    return _chosen(phase == 0, *arrays)


def _chosen(which, *arrays):
    on = np.flatnonzero(which)
    return on, *(a[..., on].astype(np.float64) if a.shape[-1] else a for a in arrays)


def vorticity_curl(
    position, velocity, phase, volume, support_radius, kernel_scale, neighbour_count, neighbour_index, pbf,
    vorticity,
):
    """Write the vorticity [1/s] of liquid particles, 0 of others.

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), volume (n,) [m^3], support_radius (n,) [m]
        and kernel_scale (2, t) (effect precision only); all pairs.
    Writes: vorticity (3, n).
    """
    on, x, v, V, R = _liquid(phase, position, velocity, volume, support_radius)
    *_, grad = tables(x, R, kernel_scale, pbf)
    v_ji = v[:, None, :] - v[:, :, None]
    vorticity[:] = 0
    vorticity[:, on] = (V * np.cross(v_ji, -grad, axis=0)).sum(axis=2)  # (7); grad_pj = -grad_pi


def vorticity_force(
    position, vorticity, phase, volume, support_radius, kernel_scale, neighbour_count, neighbour_index, pbf, dt,
    velocity,
):
    """Add vorticity confinement to the velocity [m/s] of liquid particles; not momentum conserving.

    Reads: as `vorticity_curl`, vorticity (3, n) [1/s]. Writes: velocity (3, n); others keep theirs.
    """
    on, x, om, V, R = _liquid(phase, position, vorticity, volume, support_radius)
    *_, grad = tables(x, R, kernel_scale, pbf)
    size = np.sqrt((om**2).sum(axis=0))
    eta = (V * (size[None, :] - size[:, None]) * grad).sum(axis=2)
    N = eta / (np.sqrt((eta**2).sum(axis=0)) + 1e-9 / (float(pbf.support) * float(dt)))
    push = float(dt) * float(pbf.vorticity) * np.cross(N, om, axis=0)
    velocity[:, on] = velocity[:, on].astype(np.float64) + push


def pbf_xsph(
    position, velocity, phase, mass, volume, support_radius, neighbour_count, neighbour_index, pbf, dt,
    velocity_next,
):
    """Write velocities blended with those around (8); exact in momentum. Liquid and solids; others keep theirs.

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), mass (n,) [kg], volume (n,) [m^3]; all pairs.
    Writes: velocity_next (3, n) [m/s].
    """
    on, x, v, m, V, R_i = _chosen(phase <= 1, position, velocity, mass, volume, support_radius)
    _, r = separations(x)
    R = pair_supports(x, R_i, pbf)
    W1 = 315 / (64 * np.pi * R**3) * np.where(r < R, 1 - (r / R) ** 2, 0.0) ** 3
    c = min(0.5, float(pbf.blend) * float(dt))
    weight = c * 2 * m[None, :] / (m[:, None] + m[None, :]) * (V[:, None] + V[None, :]) / 2 * W1
    solid = phase[on] == 1
    weight = np.where(solid[:, None] & solid[None, :], 0.0, weight)  # a body keeps its turn
    velocity_next[:] = velocity
    velocity_next[:, on] = v + (weight * (v[:, None, :] - v[:, :, None])).sum(axis=2)
