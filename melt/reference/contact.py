"""Contact of solids with other solids and with walls. Melting spec 3.3."""

import numpy as np

from melt.reference._pairs import separations


def contact_force(
    position, velocity, phase, mass, site, site_component, site_link_count, site_cell,
    neighbour_count, neighbour_index, contact, dt, force,
):
    r"""Add penalty, damping and Coulomb friction between solids closer than d.

    .. math::
        N = k_c (d - r) + c \, \bar m \max(-v_n, 0)/\Delta t, \quad k_c = s \bar m/\Delta t^2, \quad
        F_i = N n - \min(\mu N, \tfrac14 \bar m |v_t|/\Delta t) \, v_t/|v_t|

    with n = x_ij/r, m-bar the reduced mass (the solid's own against a wall). Pairs: surface
    particles (a bond is missing: at most ``connect`` live links, their own counted) of different
    pieces, of one piece more than 2 bonds apart (a body may touch itself), or one of them and a
    wall. Coincident particles have no normal and are left alone. The quarter keeps several contacts of one
    particle from reversing its sliding.
    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), mass (n,) [kg], site (n,),
        site_component (s,), site_link_count (s,), site_cell (3, s); all pairs; dt [s].
    Writes: adds to force (3, n) [N] of solids.
    """
    x_ij, r = separations(position)
    v = np.asarray(velocity, dtype=np.float64)
    m = np.asarray(mass, dtype=np.float64)
    d, dt = float(contact.distance), float(dt)
    solid = np.flatnonzero((phase == 1) & (site >= 0))
    shell = np.zeros(len(phase), bool)
    shell[solid] = site_link_count[site[solid]] < contact.connect + 1
    for i in np.flatnonzero(shell):
        other = shell.copy()
        cell = site_cell[:, site[shell]].astype(np.int64)
        apart = np.abs(cell - site_cell[:, [site[i]]])
        steps = {
            6: apart.sum(axis=0),
            18: np.maximum(apart.max(axis=0), np.ceil(apart.sum(axis=0) / 2)),
            26: apart.max(axis=0),
        }
        near = steps[int(contact.connect)] <= 2
        same = site_component[site[shell]] == site_component[site[i]]
        other[shell] = ~(same & near)
        j = np.flatnonzero((other | (phase == 2)) & (r[i] < d) & (r[i] >= 1e-9 * d))
        n = x_ij[:, i, j] / r[i, j]
        v_ij = v[:, [i]] - v[:, j]
        v_n = (v_ij * n).sum(axis=0)
        v_t = v_ij - v_n * n
        speed = np.sqrt((v_t**2).sum(axis=0))
        m_red = np.where(phase[j] == 2, m[i], m[i] * m[j] / (m[i] + m[j]))
        N = float(contact.stiffness) * m_red / dt**2 * (d - r[i, j])
        N += float(contact.damping) * m_red * np.maximum(-v_n, 0) / dt
        T = np.minimum(float(contact.friction) * N, 0.25 * m_red * speed / dt)
        F = N * n - T * v_t / np.where(speed > 0, speed, 1.0)
        force[:, i] += F.sum(axis=1)
