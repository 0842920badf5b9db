"""CUDA twin of `melt.reference.viscosity`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID, SOLID
from melt.physics.smoothing import W
from melt.physics.viscosity import laminar_factor


@cuda_kernel
def _laminar_force(
    position, velocity, phase, mass, volume, density, neighbour_count, neighbour_index,
    smoothing, fluid, force,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if phase[i] > SOLID:
        return
    wet = phase[i] == LIQUID
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    m_i, V_i, rho_i = mass[i], volume[i], density[i]
    fx = fy = fz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        r = math.sqrt(x * x + y * y + z * z)
        liquid = phase[j] == LIQUID
        m_j, V_j, rho_j = mass[j], volume[j], density[j]
        # a solid takes what its liquid neighbour j gets, with j in the liquid's role
        g = laminar_factor(
            r, phase[j] if wet else SOLID,
            V_i if wet else (V_j if liquid else real(1)), m_i if wet else m_j, rho_i if wet else rho_j,
            V_j if wet else V_i, m_j if wet else m_i, rho_j if wet else rho_i, smoothing, fluid,
        )
        g = g if wet | liquid else real(0)
        fx += g * (velocity[0, j] - u_i)
        fy += g * (velocity[1, j] - v_i)
        fz += g * (velocity[2, j] - w_i)
    force[0, i] += real(fx)
    force[1, i] += real(fy)
    force[2, i] += real(fz)


def laminar_force(
    position, velocity, phase, mass, volume, density, neighbour_count, neighbour_index,
    smoothing, fluid, force,
):
    """See `melt.reference.viscosity.laminar_force`."""
    _laminar_force.launch(
        phase.shape[0], position, velocity, phase, mass, volume, density, neighbour_count, neighbour_index,
        smoothing, fluid, force,
    )


@cuda_kernel
def _xsph(
    position, velocity, phase, mass, density, neighbour_count, neighbour_index,
    smoothing, fluid, velocity_next,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    rho_i = density[i]
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    du = dv = dw = wide(0)
    for k in range(neighbour_count[i] if phase[i] == LIQUID else 0):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        c = real(2) * mass[j] / (rho_i + density[j]) * W(math.sqrt(x * x + y * y + z * z), smoothing)
        c = c if phase[j] == LIQUID else real(0)
        du += c * (velocity[0, j] - u_i)
        dv += c * (velocity[1, j] - v_i)
        dw += c * (velocity[2, j] - w_i)
    velocity_next[0, i] = u_i + fluid.xsph * real(du)
    velocity_next[1, i] = v_i + fluid.xsph * real(dv)
    velocity_next[2, i] = w_i + fluid.xsph * real(dw)


def xsph(
    position, velocity, phase, mass, density, neighbour_count, neighbour_index,
    smoothing, fluid, velocity_next,
):
    """See `melt.reference.viscosity.xsph`."""
    _xsph.launch(
        phase.shape[0], position, velocity, phase, mass, density, neighbour_count, neighbour_index,
        smoothing, fluid, velocity_next,
    )
