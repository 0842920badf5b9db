r"""Rigid-component baseline: every connected component moves as one rigid body.

A reconstruction of the comparison method of the paper's Fig 7 (Iwasaki et al. 2010), whose text
it does not print: per component the best rigid pose of the particles, and the linear and angular
acceleration by the sum of its forces. Goals and forces then go through the same kick and drift
as lattice shape matching, which keeps the pose rigid to the order (omega dt)^2 / 2 of one
sub-step, corrected in the next. Component fields stand at the component's smallest site.
"""

import numpy as np

from melt.reference._lattice import rotation, turn


def _members(site_component, position, mass, site_particle, site_cell, dx, root):
    """Return sites, masses, positions and rest positions relative to those of the root."""
    members = np.flatnonzero(site_component == root)
    p = site_particle[members]
    x = position.astype(np.float64)
    d = x[:, p] - x[:, [site_particle[root]]]
    X = dx * (site_cell[:, members] - site_cell[:, [root]])
    return members, p, mass[p].astype(np.float64), d, X


def rigid_match(
    position, force, mass, site_particle, site_component, site_cell, lattice, component_centre,
    component_rest,
    component_rotation, component_push, component_twist,
):
    """Write pose and acceleration of every component.

    Reads: position (3, n) [m], force (3, n) [N], mass (n,) [kg], site_particle, site_component (s,),
        site_cell (3, s), and the previous component_rotation, as `region_match` does.
    Writes, at the smallest site of each component: component_centre and component_rest (3, s) [m],
        relative to that site; component_rotation (4, s); component_push = F / M [m/s^2];
        component_twist = I^+ torque [1/s^2], axes below 1e-8 of the largest moment dropped.
    """
    dx = float(lattice.spacing)
    for root in np.unique(site_component[site_component >= 0]):
        _, p, m, d, X = _members(site_component, position, mass, site_particle, site_cell, dx, root)
        c, c0 = d @ m / m.sum(), X @ m / m.sum()
        y = d - c[:, None]
        F = force[:, p].astype(np.float64)
        component_centre[:, root], component_rest[:, root] = c, c0
        A = (m * y) @ (X - c0[:, None]).T
        component_rotation[:, root] = rotation(A, component_rotation[:, root].astype(np.float64))
        component_push[:, root] = F.sum(axis=1) / m.sum()
        inertia = (m * (y * y).sum(axis=0)).sum() * np.eye(3) - (m * y) @ y.T
        moment, axes = np.linalg.eigh(inertia)
        keep = moment > 1e-8 * moment[-1]
        torque = np.cross(y.T, F.T).sum(axis=0)
        component_twist[:, root] = axes[:, keep] @ ((axes[:, keep].T @ torque) / moment[keep])


def rigid_goal(
    position, mass, site_particle, site_component, site_cell, component_centre, component_rest,
    component_rotation,
    component_push, component_twist, lattice, force, goal,
):
    """Write goal displacements R (X0 - c0) + c - x of live sites (0 for others) and rigid forces.

    The force on a solid particle becomes m (F / M + alpha x (x - c)): same sum, same torque.

    Writes: force (3, n) [N] of solid particles; goal (3, s) [m].
    """
    goal[:] = 0
    for root in np.unique(site_component[site_component >= 0]):
        members, p, m, d, X = _members(
            site_component, position, mass, site_particle, site_cell, float(lattice.spacing), root
        )
        y = d - component_centre[:, [root]]
        R = turn(component_rotation[:, root].astype(np.float64))
        goal[:, members] = R @ (X - component_rest[:, [root]]) - y
        force[:, p] = m * (component_push[:, [root]] + np.cross(component_twist[:, root], y.T).T)
