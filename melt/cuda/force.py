"""CUDA twin of `melt.reference.force`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.coupling import pair_factor
from melt.physics.phases import LIQUID, SOLID


@cuda_kernel
def _fluid_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if phase[i] == SOLID:
        return
    if phase[i] != LIQUID:
        force[0, i] = force[1, i] = force[2, i] = real(0)
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    m_i, V_i, rho_i, p_i = mass[i], volume[i], density[i], pressure[i]
    fx = fy = fz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
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


def fluid_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    """See `melt.reference.force.fluid_force`."""
    _fluid_force.launch(
        phase.shape[0], position, velocity, phase, mass, volume, density, pressure, boundary_pressure,
        neighbour_count, neighbour_index, smoothing, fluid, force,
    )


@cuda_kernel
def _reaction_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if phase[i] != SOLID:
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    m_i, V_i, rho_i = mass[i], volume[i], density[i]
    fx = fy = fz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        if phase[j] != LIQUID:
            continue
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        v_x = (u_i - velocity[0, j]) * x + (v_i - velocity[1, j]) * y + (w_i - velocity[2, j]) * z
        g_x = fluid.gravity_x * x + fluid.gravity_y * y + fluid.gravity_z * z
        # the liquid's own formula from the solid's side: F_{k<-i} = -f x_ik = f x_ki
        f = pair_factor(
            x * x + y * y + z * z, v_x, -g_x, SOLID, volume[j], mass[j], density[j], pressure[j], boundary_pressure[j],
            V_i, m_i, rho_i, real(0), smoothing, fluid,
        )
        fx += f * x
        fy += f * y
        fz += f * z
    force[0, i] = real(fx) + m_i * fluid.gravity_x
    force[1, i] = real(fy) + m_i * fluid.gravity_y
    force[2, i] = real(fz) + m_i * fluid.gravity_z


def reaction_force(
    position, velocity, phase, mass, volume, density, pressure, boundary_pressure, neighbour_count,
    neighbour_index, smoothing, fluid, force,
):
    """See `melt.reference.force.reaction_force`."""
    _reaction_force.launch(
        phase.shape[0], position, velocity, phase, mass, volume, density, pressure, boundary_pressure,
        neighbour_count, neighbour_index, smoothing, fluid, force,
    )
