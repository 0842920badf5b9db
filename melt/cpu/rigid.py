"""CPU twin of `melt.reference.rigid`."""

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.polar import rotation, solve_inertia
from melt.physics.quaternion import rotate


@cpu_helper
def _sums(root, position, force, mass, site_particle, site_component, site_cell, dx, centre, rest, push):
    """Write centre of mass, its rest position and the acceleration of one component."""
    real, wide = type(dx), position.dtype.type  # sums are as wide as positions (precision `mixed`)
    o = site_particle[root]
    M, Fx, Fy, Fz = wide(0), wide(0), wide(0), wide(0)
    cx, cy, cz, X, Y, Z = wide(0), wide(0), wide(0), wide(0), wide(0), wide(0)
    for s in range(root, site_component.shape[0]):
        if site_component[s] != root:
            continue
        p = site_particle[s]
        m = wide(mass[p])
        M += m
        cx += m * (position[0, p] - position[0, o])
        cy += m * (position[1, p] - position[1, o])
        cz += m * (position[2, p] - position[2, o])
        X += m * wide(site_cell[0, s] - site_cell[0, root])
        Y += m * wide(site_cell[1, s] - site_cell[1, root])
        Z += m * wide(site_cell[2, s] - site_cell[2, root])
        Fx += force[0, p]
        Fy += force[1, p]
        Fz += force[2, p]
    centre[0, root], centre[1, root], centre[2, root] = real(cx / M), real(cy / M), real(cz / M)
    rest[0, root], rest[1, root], rest[2, root] = real(X / M) * dx, real(Y / M) * dx, real(Z / M) * dx
    push[0, root], push[1, root], push[2, root] = real(Fx / M), real(Fy / M), real(Fz / M)


@cpu_helper
def _pose(
    root, position, force, mass, site_particle, site_component, site_cell, lattice, centre, rest, rotations,
    twist,
):
    """Write rotation and angular acceleration of one component, about its centre."""
    real, wide = type(lattice.spacing), position.dtype.type
    dx = wide(lattice.spacing)
    o = site_particle[root]
    a0, a1, a2, a3, a4 = wide(0), wide(0), wide(0), wide(0), wide(0)
    a5, a6, a7, a8 = wide(0), wide(0), wide(0), wide(0)
    xx, yy, zz, xy, xz, yz = wide(0), wide(0), wide(0), wide(0), wide(0), wide(0)
    tx, ty, tz = wide(0), wide(0), wide(0)
    for s in range(root, site_component.shape[0]):
        if site_component[s] != root:
            continue
        p = site_particle[s]
        m = wide(mass[p])
        x = position[0, p] - position[0, o] - centre[0, root]
        y = position[1, p] - position[1, o] - centre[1, root]
        z = position[2, p] - position[2, o] - centre[2, root]
        X = wide(site_cell[0, s] - site_cell[0, root]) * dx - rest[0, root]
        Y = wide(site_cell[1, s] - site_cell[1, root]) * dx - rest[1, root]
        Z = wide(site_cell[2, s] - site_cell[2, root]) * dx - rest[2, root]
        u, v, w = m * x, m * y, m * z
        a0, a1, a2 = a0 + u * X, a1 + u * Y, a2 + u * Z
        a3, a4, a5 = a3 + v * X, a4 + v * Y, a5 + v * Z
        a6, a7, a8 = a6 + w * X, a7 + w * Y, a8 + w * Z
        xx, yy, zz = xx + u * x, yy + v * y, zz + w * z
        xy, xz, yz = xy + u * y, xz + u * z, yz + v * z
        tx += y * force[2, p] - z * force[1, p]
        ty += z * force[0, p] - x * force[2, p]
        tz += x * force[1, p] - y * force[0, p]
    q = rotation(
        (real(a0), real(a1), real(a2), real(a3), real(a4), real(a5), real(a6), real(a7), real(a8)),
        (rotations[0, root], rotations[1, root], rotations[2, root], rotations[3, root]),
        lattice,
    )
    rotations[0, root], rotations[1, root], rotations[2, root], rotations[3, root] = q
    twist[0, root], twist[1, root], twist[2, root] = solve_inertia(
        (real(yy + zz), real(xx + zz), real(xx + yy), real(-xy), real(-xz), real(-yz)),
        (real(tx), real(ty), real(tz)),
    )


@cpu_stage
def rigid_match(
    position, force, mass, site_particle, site_component, site_cell, lattice, component_centre,
    component_rest,
    component_rotation, component_push, component_twist,
):
    """See `melt.reference.rigid.rigid_match`: one thread per component, its sites in ascending order."""
    for root in prange(site_component.shape[0]):
        if site_component[root] == root:
            _sums(
                root, position, force, mass, site_particle, site_component, site_cell, lattice.spacing,
                component_centre, component_rest, component_push,
            )
            _pose(
                root, position, force, mass, site_particle, site_component, site_cell, lattice,
                component_centre,
                component_rest, component_rotation, component_twist,
            )


@cpu_stage
def rigid_goal(
    position, mass, site_particle, site_component, site_cell, component_centre, component_rest,
    component_rotation,
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
