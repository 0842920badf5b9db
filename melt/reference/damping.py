r"""Damping towards region-rigid motion. Melting spec 2.7.

.. math:: v_r = \sum \tilde m v / M_r,\quad L_r = \sum \tilde m (x - c_r) \times (v - v_r),\quad
    \omega_r = I_r^+ L_r

.. math:: v_i \leftarrow v_i + k \frac{1}{n_i} \sum_{r \ni i} [ v_r + \omega_r \times (x_i - c_r) - v_i ]
"""

import numpy as np


def region_motion(
    velocity, site_particle, site_position, site_region, site_region_count, region_share, region_mass,
    site_velocity, region_centre, region_velocity, region_spin,
):
    """Write centre, mean velocity and angular velocity of every region; 0 for empty ones.

    The pseudo-inverse drops axes whose moment of inertia is below 1e-8 of the largest: a rod does
    not spin about itself.

    Reads: velocity (3, n) [m/s], site_particle (s,), site_position (3, s) [m] from `region_match`,
        site_region (s, (2w+1)^3), site_region_count (s,), region_share and region_mass (s,) [kg].
    Writes: site_velocity (3, s) [m/s]; region_centre (3, s) [m], relative to the own particle;
        region_velocity (3, s) [m/s]; region_spin (3, s) [1/s].
    """
    v = np.where(site_particle >= 0, velocity[:, np.maximum(site_particle, 0)].astype(np.float64), 0.0)
    site_velocity[:] = v
    region_centre[:] = 0
    region_velocity[:] = 0
    region_spin[:] = 0
    x = site_position.astype(np.float64)
    for r in np.flatnonzero(site_region_count > 0):
        members = site_region[r][site_region[r] >= 0]
        mt = region_share[members].astype(np.float64)
        M = mt.sum()
        d = x[:, members] - x[:, [r]]
        c = d @ mt / M
        vr = v[:, members] @ mt / M
        y = d - c[:, None]
        angular = (mt * np.cross(y.T, (v[:, members] - vr[:, None]).T).T).sum(axis=1)
        inertia = (mt * (y * y).sum(axis=0)).sum() * np.eye(3) - (mt * y) @ y.T
        moment, axes = np.linalg.eigh(inertia)
        keep = moment > 1e-8 * moment[-1]
        region_spin[:, r] = axes[:, keep] @ ((axes[:, keep].T @ angular) / moment[keep])
        region_centre[:, r], region_velocity[:, r] = c, vr


def damp_velocity(
    site_particle, site_position, site_velocity, site_region, site_region_count, region_centre,
    region_velocity,
    region_spin, factor, velocity,
):
    """Blend the velocity of solid particles towards the mean of their regions' rigid motions.

    Reads: site_particle (s,), site_position (3, s) [m], site_velocity (3, s) [m/s], site_region,
        site_region_count, region_centre, region_velocity, region_spin; factor in [0, 1].
    Writes: velocity (3, n) [m/s] of solid particles.
    """
    x = site_position.astype(np.float64)
    for i in np.flatnonzero(site_region_count > 0):
        r = site_region[i][site_region[i] >= 0]
        y = x[:, [i]] - x[:, r] - region_centre[:, r]
        rigid = region_velocity[:, r] + np.cross(region_spin[:, r].T, y.T).T
        own = site_velocity[:, i].astype(np.float64)
        velocity[:, site_particle[i]] = own + float(factor) * (rigid.mean(axis=1) - own)
