"""CUDA twin of `melt.reference.sph`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID
from melt.physics.sph import displaced, pair_factors, poly6_raw


@cuda_kernel
def _sph_density(position, phase, rest_volume, neighbour_count, neighbour_index, sph, density, pressure, constraint):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(sph.support)
    wide = position.dtype.type
    if phase[i] != LIQUID:
        density[i], pressure[i], constraint[i] = sph.rest_density, real(0), real(0)
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    total = wide(rest_volume[i] * poly6_raw(real(0), sph))
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        total += displaced(phase[j], rest_volume[j]) * poly6_raw(x * x + y * y + z * z, sph)
    C = real(total - wide(1))  # the difference before it is rounded
    density[i] = sph.rest_density * real(total)
    constraint[i] = C
    pressure[i] = sph.stiffness * max(C, real(0))


def sph_density(position, phase, rest_volume, neighbour_count, neighbour_index, sph, density, pressure, constraint):
    """See `melt.reference.sph.sph_density`."""
    _sph_density.launch(
        phase.shape[0], position, phase, rest_volume, neighbour_count, neighbour_index, sph, density, pressure, constraint,
    )


@cuda_kernel
def _sph_force(
    position, velocity, phase, rest_volume, density, pressure, neighbour_count, neighbour_index, sph, dt, velocity_next,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(sph.support)
    wide = position.dtype.type
    wet = phase[i] == LIQUID
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    P_i = pressure[i]
    ax = ay = az = wide(0)
    for k in range(neighbour_count[i] if wet else 0):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        f, g = pair_factors(x * x + y * y + z * z, phase[j], rest_volume[j], density[j], pressure[j], P_i, sph)
        ax += f * x + g * (velocity[0, j] - u_i)
        ay += f * y + g * (velocity[1, j] - v_i)
        az += f * z + g * (velocity[2, j] - w_i)
    scale = dt / density[i] if wet else real(0)
    velocity_next[0, i] = u_i + scale * real(ax)
    velocity_next[1, i] = v_i + scale * real(ay)
    velocity_next[2, i] = w_i + scale * real(az)


def sph_force(
    position, velocity, phase, rest_volume, density, pressure, neighbour_count, neighbour_index, sph, dt, velocity_next,
):
    """See `melt.reference.sph.sph_force`."""
    _sph_force.launch(
        phase.shape[0], position, velocity, phase, rest_volume, density, pressure, neighbour_count, neighbour_index,
        sph, dt, velocity_next,
    )
