"""CUDA twin of `melt.reference.boost`."""

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.physics.boiling import boosted, viscosity_ratio
from melt.physics.pbf import support_of, xsph_weight
from melt.physics.phases import LIQUID


@cuda_kernel
def _liquid_sums(phase, mass, velocity, temperature, liquid_sums):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], liquid_sums.shape[1]
    if p >= pieces:
        return
    M = U = V = W = H = np.float64(0)
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        if phase[i] == LIQUID:
            m = np.float64(mass[i])
            M += m
            U += m * np.float64(velocity[0, i])
            V += m * np.float64(velocity[1, i])
            W += m * np.float64(velocity[2, i])
            H += m * np.float64(temperature[i])
    liquid_sums[0, p] = M
    liquid_sums[1, p] = U
    liquid_sums[2, p] = V
    liquid_sums[3, p] = W
    liquid_sums[4, p] = H


def liquid_sums(phase, mass, velocity, temperature, liquid_sums):
    """See `melt.reference.boost.liquid_sums`."""
    _liquid_sums.launch(liquid_sums.shape[1], phase, mass, velocity, temperature, liquid_sums)


@cuda_kernel
def _boost(phase, temperature, fluid, boiling, mean_u, mean_v, mean_w, mean_temperature, dt, velocity):
    i = cuda.grid(1)
    if i < phase.shape[0] and phase[i] == LIQUID:
        velocity[0, i], velocity[1, i], velocity[2, i] = boosted(
            velocity[0, i], velocity[1, i], velocity[2, i], temperature[i], mean_u, mean_v, mean_w,
            mean_temperature, fluid, boiling, dt,
        )


def boost(phase, temperature, fluid, boiling, mean_u, mean_v, mean_w, mean_temperature, dt, velocity):
    """See `melt.reference.boost.boost`."""
    _boost.launch(
        phase.shape[0], phase, temperature, fluid, boiling, mean_u, mean_v, mean_w, mean_temperature, dt, velocity,
    )


@cuda_kernel
def _shift_velocity(phase, mean_u, mean_v, mean_w, velocity):
    i = cuda.grid(1)
    if i < phase.shape[0] and phase[i] == LIQUID:
        velocity[0, i] -= mean_u
        velocity[1, i] -= mean_v
        velocity[2, i] -= mean_w


def shift_velocity(phase, mean_u, mean_v, mean_w, velocity):
    """See `melt.reference.boost.shift_velocity`."""
    _shift_velocity.launch(phase.shape[0], phase, mean_u, mean_v, mean_w, velocity)


@cuda_kernel
def _boost_xsph(
    position, velocity, phase, mass, volume, temperature, support_radius, neighbour_count, neighbour_index, pbf, dt,
    velocity_next,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    c = min(real(0.5), pbf.blend * dt)
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    m_i, V_i, mu_i = mass[i], volume[i], viscosity_ratio(temperature[i])
    du = dv = dw = wide(0)
    for k in range(neighbour_count[i] if phase[i] == LIQUID else 0):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        inverse = real(1) / support_of(i, j, support_radius, pbf)
        f = xsph_weight(x * x + y * y + z * z, inverse, m_i, mass[j], V_i, volume[j])
        f *= real(0.5) * (mu_i + viscosity_ratio(temperature[j]))
        f = f if phase[j] == LIQUID else real(0)
        du += f * (velocity[0, j] - u_i)
        dv += f * (velocity[1, j] - v_i)
        dw += f * (velocity[2, j] - w_i)
    velocity_next[0, i] = u_i + c * real(du)
    velocity_next[1, i] = v_i + c * real(dv)
    velocity_next[2, i] = w_i + c * real(dw)


def boost_xsph(
    position, velocity, phase, mass, volume, temperature, support_radius, neighbour_count, neighbour_index, pbf, dt,
    velocity_next,
):
    """See `melt.reference.boost.boost_xsph`."""
    _boost_xsph.launch(
        phase.shape[0], position, velocity, phase, mass, volume, temperature, support_radius, neighbour_count,
        neighbour_index, pbf, dt, velocity_next,
    )
