"""CPU twin of `melt.reference.rigid`. Sums over a whole component are always float64."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.polar import rotation, solve_inertia
from melt.physics.quaternion import rotate


@cpu_stage
def rigid_match(
    position, force, mass, site_particle, site_component, site_cell, lattice, component_centre, component_rest,
    component_rotation, component_push, component_twist,
):
    """See `melt.reference.rigid.rigid_match`: one thread per component, its sites in ascending order."""
    real = type(lattice.spacing)
    dx = np.float64(lattice.spacing)
    count = site_component.shape[0]
    for root in prange(count):
        if site_component[root] != root:
            continue
        p = site_particle[root]
        x_r, y_r, z_r = position[0, p], position[1, p], position[2, p]
        M, cx, cy, cz, X0, Y0, Z0, Fx, Fy, Fz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for s in range(root, count):
            if site_component[s] != root:
                continue
            p = site_particle[s]
            m = np.float64(mass[p])
            M += m
            cx += m * (position[0, p] - x_r)
            cy += m * (position[1, p] - y_r)
            cz += m * (position[2, p] - z_r)
            X0 += m * (site_cell[0, s] - site_cell[0, root])
            Y0 += m * (site_cell[1, s] - site_cell[1, root])
            Z0 += m * (site_cell[2, s] - site_cell[2, root])
            Fx += force[0, p]
            Fy += force[1, p]
            Fz += force[2, p]
        cx, cy, cz, X0, Y0, Z0 = cx / M, cy / M, cz / M, X0 / M, Y0 / M, Z0 / M
        a0, a1, a2, a3, a4, a5, a6, a7, a8 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        xx, yy, zz, xy, xz, yz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for s in range(root, count):
            if site_component[s] != root:
                continue
            p = site_particle[s]
            m = np.float64(mass[p])
            x = (position[0, p] - x_r) - cx
            y = (position[1, p] - y_r) - cy
            z = (position[2, p] - z_r) - cz
            X = (site_cell[0, s] - site_cell[0, root]) - X0
            Y = (site_cell[1, s] - site_cell[1, root]) - Y0
            Z = (site_cell[2, s] - site_cell[2, root]) - Z0
            a0 += m * x * X
            a1 += m * x * Y
            a2 += m * x * Z
            a3 += m * y * X
            a4 += m * y * Y
            a5 += m * y * Z
            a6 += m * z * X
            a7 += m * z * Y
            a8 += m * z * Z
            xx += m * x * x
            yy += m * y * y
            zz += m * z * z
            xy += m * x * y
            xz += m * x * z
            yz += m * y * z
            tx += y * force[2, p] - z * force[1, p]
            ty += z * force[0, p] - x * force[2, p]
            tz += x * force[1, p] - y * force[0, p]
        q = rotation(
            (real(a0), real(a1), real(a2), real(a3), real(a4), real(a5), real(a6), real(a7), real(a8)),
            (
                component_rotation[0, root], component_rotation[1, root], component_rotation[2, root],
                component_rotation[3, root],
            ),
            lattice,
        )
        for a in range(4):
            component_rotation[a, root] = q[a]
        twist = solve_inertia((yy + zz, xx + zz, xx + yy, -xy, -xz, -yz), (tx, ty, tz))
        component_twist[0, root], component_twist[1, root], component_twist[2, root] = twist
        component_push[0, root], component_push[1, root], component_push[2, root] = Fx / M, Fy / M, Fz / M
        component_centre[0, root], component_centre[1, root], component_centre[2, root] = cx, cy, cz
        component_rest[0, root], component_rest[1, root], component_rest[2, root] = X0 * dx, Y0 * dx, Z0 * dx


@cpu_stage
def rigid_goal(
    position, mass, site_particle, site_component, site_cell, component_centre, component_rest, component_rotation,
    component_push, component_twist, lattice, force, goal,
):
    """See `melt.reference.rigid.rigid_goal`."""
    real = type(lattice.spacing)
    dx = lattice.spacing
    for s in prange(site_component.shape[0]):
        root = site_component[s]
        if root < 0:
            for a in range(3):
                goal[a, s] = real(0)
            continue
        p, o = site_particle[s], site_particle[root]
        x = real(position[0, p] - position[0, o]) - component_centre[0, root]
        y = real(position[1, p] - position[1, o]) - component_centre[1, root]
        z = real(position[2, p] - position[2, o]) - component_centre[2, root]
        r = rotate(
            component_rotation[0, root], component_rotation[1, root], component_rotation[2, root],
            component_rotation[3, root],
            real(site_cell[0, s] - site_cell[0, root]) * dx - component_rest[0, root],
            real(site_cell[1, s] - site_cell[1, root]) * dx - component_rest[1, root],
            real(site_cell[2, s] - site_cell[2, root]) * dx - component_rest[2, root],
        )
        goal[0, s], goal[1, s], goal[2, s] = r[0] - x, r[1] - y, r[2] - z
        a, b, c = component_twist[0, root], component_twist[1, root], component_twist[2, root]
        force[0, p] = mass[p] * (component_push[0, root] + b * z - c * y)
        force[1, p] = mass[p] * (component_push[1, root] + c * x - a * z)
        force[2, p] = mass[p] * (component_push[2, root] + a * y - b * x)
