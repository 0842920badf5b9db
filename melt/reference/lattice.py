r"""Lattice shape matching. Melting spec 2.7 (Rivers and James).

Region r holds the live sites within w hops of site r, itself included; membership is symmetric.
A member at slot k has the rest position X0_r + o_k dx with the voxel offset o_k of the slot:
bodies lie on the lattice in their rest frame, so these differences are exact.

.. math:: \tilde m_i = m_i / n_i,\quad M_r = \sum \tilde m,\quad
    c_r = \sum \tilde m x / M_r,\quad A_r = \sum \tilde m (x - c_r)(X^0 - c^0_r)^T = R_r S

.. math:: g_i = \frac{1}{n_i} \sum_{r \ni i} [ R_r (X^0_i - c^0_r) + c_r ]

Everything is kept relative to the region's own particle x_r and rest position X0_r, and goals
as g - x: rounding is then that of the region's size, not of its place in the world.
"""

import numpy as np

from melt.reference._lattice import offsets, rotation, turn


def region_share(mass, site_particle, site_region_count, region_share):
    """Write the mass share m_i / n_i [kg] of live sites, 0 for others.

    Reads: mass (n,) [kg], site_particle (s,), site_region_count (s,).
    Writes: region_share (s,) [kg].
    """
    live = site_region_count > 0
    region_share[:] = 0
    region_share[live] = mass[site_particle[live]].astype(np.float64) / site_region_count[live]


def region_rest(site_region, site_region_count, site_dirty, region_share, lattice, region_mass, region_rest):
    """Write mass and rest centre of the regions whose ``site_dirty`` has bit 2; 0 for empty ones.

    Reads: site_region (s, (2w+1)^3), site_region_count, site_dirty (s,), region_share (s,) [kg].
    Writes: region_mass (s,) [kg], region_rest (3, s) [m], relative to the own site.
    """
    X0 = offsets(site_region.shape[1]) * float(lattice.spacing)
    for r in np.flatnonzero(site_dirty & 2):
        slots = np.flatnonzero(site_region[r] >= 0) if site_region_count[r] > 0 else np.empty(0, int)
        mt = region_share[site_region[r, slots]].astype(np.float64)
        M = mt.sum()
        region_mass[r] = M
        region_rest[:, r] = mt @ X0[slots] / M if M > 0 else 0.0


def region_match(
    position, site_particle, site_region, site_region_count, region_share, region_mass, region_rest,
    lattice, site_position, region_rotation, region_mean, region_shift,
):
    """Write the rotation R_r of every region and what goals need of it.

    Reads: position (3, n) [m], site_particle (s,), site_region (s, (2w+1)^3), site_region_count
        (s,), region_share (s,) and region_mass (s,) [kg], region_rest (3, s) [m], and the
        previous region_rotation, which decides where A leaves the rotation open.
    Writes: site_position (3, s) [m]; region_rotation (4, s); region_mean (3, s) = mean of
        x_i - x_r over the members [m]; region_shift (3, s) = c_r - x_r + R_r (X0_r - c0_r) [m].
        Empty regions keep their rotation, the rest is 0.
    """
    dx = float(lattice.spacing)
    X0 = offsets(site_region.shape[1]) * dx
    x = np.where(site_particle >= 0, position[:, np.maximum(site_particle, 0)].astype(np.float64), 0.0)
    site_position[:] = x
    region_mean[:] = 0
    region_shift[:] = 0
    for r in np.flatnonzero(site_region_count > 0):
        slots = np.flatnonzero(site_region[r] >= 0)
        members = site_region[r, slots]
        mt = region_share[members].astype(np.float64)
        M = mt.sum()
        c0 = mt @ X0[slots] / M
        d = x[:, members] - x[:, [r]]
        c = d @ mt / M
        A = ((d - c[:, None]) * mt) @ (X0[slots] - c0)
        q = rotation(A, region_rotation[:, r].astype(np.float64))
        region_rotation[:, r] = q
        region_mean[:, r] = d.mean(axis=1)
        region_shift[:, r] = c - turn(q) @ c0


def goal(site_region, site_region_count, region_rotation, region_mean, region_shift, lattice, goal):
    """Write g_i - x_i of live sites, 0 for others.

    With symmetric membership g_i - x_i = (1/n_i) Sum_r [R_r (X0_i - X0_r) + shift_r] + mean_i,
    where Sum_r (x_r - x_i) / n_i = mean_i: no position enters.

    Reads: site_region (s, (2w+1)^3), site_region_count (s,), region_rotation (4, s), region_mean
        and region_shift (3, s) [m].
    Writes: goal (3, s) [m].
    """
    X0 = offsets(site_region.shape[1]) * float(lattice.spacing)
    R = np.stack([turn(q) for q in region_rotation.T.astype(np.float64)]) if len(goal[0]) else None
    goal[:] = 0
    for i in np.flatnonzero(site_region_count > 0):
        slots = np.flatnonzero(site_region[i] >= 0)
        r = site_region[i, slots]
        # X0_i - X0_r is minus the offset of r as seen from i
        predicted = np.einsum("rab,rb->ra", R[r], -X0[slots]) + region_shift[:, r].T
        goal[:, i] = predicted.mean(axis=0) + region_mean[:, i]
