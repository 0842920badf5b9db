"""CPU twin of `melt.reference.force`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.coupling import pair_factor
from melt.physics.phases import LIQUID, SOLID


@cpu_stage
def fluid_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    """See `melt.reference.force.fluid_force`."""
    real = type(smoothing.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] == SOLID:
            continue
        if phase[i] != LIQUID:
            force[0, i] = force[1, i] = force[2, i] = real(0)
            continue
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
        m_i, V_i, rho_i, p_i = mass[i], volume[i], density[i], pressure[i]
        fx = fy = fz = wide(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            v_x = (u_i - velocity[0, j]) * x + (v_i - velocity[1, j]) * y + (w_i - velocity[2, j]) * z
            g_x = fluid.gravity_x * x + fluid.gravity_y * y + fluid.gravity_z * z
            f = pair_factor(
                x * x + y * y + z * z, v_x, g_x, phase[j], V_i, m_i, rho_i, p_i, boundary_pressure[i],
                volume[j], mass[j], density[j], pressure[j], smoothing, fluid,
            )
            fx += f * x
            fy += f * y
            fz += f * z
        force[0, i] = real(fx) + m_i * fluid.gravity_x
        force[1, i] = real(fy) + m_i * fluid.gravity_y
        force[2, i] = real(fz) + m_i * fluid.gravity_z


@cpu_stage
def reaction_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    """See `melt.reference.force.reaction_force`."""
    real = type(smoothing.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != SOLID:
            continue
        # dry particles, most of a solid, are told by one gather a pair instead of eleven
        wet = 0
        for k in range(np.uint64(neighbour_count[i])):
            wet += phase[np.uint64(neighbour_index[i, k])] == LIQUID
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
        m_i, V_i, rho_i = mass[i], volume[i], density[i]
        fx = fy = fz = wide(0)
        for k in range(np.uint64(neighbour_count[i] if wet > 0 else 0)):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            v_x = (u_i - velocity[0, j]) * x + (v_i - velocity[1, j]) * y + (w_i - velocity[2, j]) * z
            g_x = fluid.gravity_x * x + fluid.gravity_y * y + fluid.gravity_z * z
            # the liquid's own formula from the solid's side: F_{k<-i} = -f x_ik = f x_ki
            liquid = phase[j] == LIQUID
            V_j = volume[j] if liquid else real(1)  # keeps what is dropped finite
            f = pair_factor(
                x * x + y * y + z * z, v_x, -g_x, SOLID, V_j, mass[j], density[j], pressure[j], boundary_pressure[j],
                V_i, m_i, rho_i, real(0), smoothing, fluid,
            )
            f = f if liquid else real(0)
            fx += f * x
            fy += f * y
            fz += f * z
        force[0, i] = real(fx) + m_i * fluid.gravity_x
        force[1, i] = real(fy) + m_i * fluid.gravity_y
        force[2, i] = real(fz) + m_i * fluid.gravity_z
