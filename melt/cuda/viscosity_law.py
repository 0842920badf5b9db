"""CUDA twin of `melt.reference.viscosity_law`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID
from melt.physics.viscous import apparent_viscosity, capped, thermal_viscosity


@cuda_kernel
def _shear_rate(velocity, neighbour_count, neighbour_index, pair_gradient, shear_rate):
    i = cuda.grid(1)
    if i >= shear_rate.shape[0]:
        return
    real = velocity.dtype.type
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    xx = yy = zz = xy = xz = yz = real(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        u, v, w = velocity[0, j] - u_i, velocity[1, j] - v_i, velocity[2, j] - w_i
        gx, gy, gz = pair_gradient[0, i, k], pair_gradient[1, i, k], pair_gradient[2, i, k]
        xx += u * gx
        yy += v * gy
        zz += w * gz
        xy += u * gy + v * gx
        xz += u * gz + w * gx
        yz += v * gz + w * gy
    shear_rate[i] = math.sqrt(real(2) * (xx * xx + yy * yy + zz * zz) + xy * xy + xz * xz + yz * yz)


def shear_rate(velocity, neighbour_count, neighbour_index, pair_gradient, shear_rate):
    """See `melt.reference.viscosity_law.shear_rate`."""
    _shear_rate.launch(
        shear_rate.shape[0], velocity, neighbour_count, neighbour_index, pair_gradient, shear_rate
    )


@cuda_kernel
def _viscosity(phase, temperature, shear_rate, viscous, viscosity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] != LIQUID:
        viscosity[i] = type(viscous.mu)(0)
        return
    mu = thermal_viscosity(temperature[i], viscous) if temperature.shape[0] > 0 else viscous.mu
    mu = apparent_viscosity(mu, shear_rate[i], viscous) if shear_rate.shape[0] > 0 else mu
    viscosity[i] = capped(mu, viscous)


def viscosity(phase, temperature, shear_rate, viscous, viscosity):
    """See `melt.reference.viscosity_law.viscosity`."""
    _viscosity.launch(phase.shape[0], phase, temperature, shear_rate, viscous, viscosity)
