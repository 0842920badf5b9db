"""CUDA twin of `melt.reference.contact`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.contact import contact_friction, contact_normal, lattice_steps, reduced_mass
from melt.physics.phases import SOLID, WALL


@cuda_kernel
def _contact_force(
    position, velocity, phase, mass, site, site_component, site_link_count, site_cell,
    neighbour_count, neighbour_index, contact, dt, force,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(dt)
    wide = position.dtype.type
    d = contact.distance
    if phase[i] != SOLID:
        return
    s = site[i]
    if site_link_count[s] > contact.connect:
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    fx = fy = fz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        if phase[j] != SOLID and phase[j] != WALL:
            continue
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        r = math.sqrt(x * x + y * y + z * z)
        if r >= d or r < real(1e-9) * d:
            continue
        wall = phase[j] == WALL
        if not wall:
            t = site[j]
            if site_link_count[t] > contact.connect:
                continue
            steps = lattice_steps(
                site_cell[0, t] - site_cell[0, s],
                site_cell[1, t] - site_cell[1, s],
                site_cell[2, t] - site_cell[2, s],
                contact.connect,
            )
            if steps <= 2 and site_component[t] == site_component[s]:
                continue
        x, y, z = x / r, y / r, z / r
        u = velocity[0, i] - velocity[0, j]
        v = velocity[1, i] - velocity[1, j]
        w = velocity[2, i] - velocity[2, j]
        v_n = u * x + v * y + w * z
        u, v, w = u - v_n * x, v - v_n * y, w - v_n * z
        m = reduced_mass(mass[i], mass[j], wall)
        normal = contact_normal(r, v_n, m, contact, dt)
        b = contact_friction(normal, math.sqrt(u * u + v * v + w * w), m, contact, dt)
        fx += normal * x - b * u
        fy += normal * y - b * v
        fz += normal * z - b * w
    force[0, i] += real(fx)
    force[1, i] += real(fy)
    force[2, i] += real(fz)


def contact_force(
    position, velocity, phase, mass, site, site_component, site_link_count, site_cell,
    neighbour_count, neighbour_index, contact, dt, force,
):
    """See `melt.reference.contact.contact_force`."""
    _contact_force.launch(
        phase.shape[0], position, velocity, phase, mass, site, site_component, site_link_count, site_cell,
        neighbour_count, neighbour_index, contact, dt, force,
    )
