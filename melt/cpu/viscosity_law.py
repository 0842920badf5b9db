"""CPU twin of `melt.reference.viscosity_law`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.phases import LIQUID
from melt.physics.viscous import apparent_viscosity, capped, thermal_viscosity


@cpu_stage
def shear_rate(velocity, neighbour_count, neighbour_index, pair_gradient, shear_rate):
    """See `melt.reference.viscosity_law.shear_rate`."""
    real = velocity.dtype.type
    n = shear_rate.shape[0]
    for chunk in prange(64):
        piece = (chunk * 37) % 64  # dealt out: walls have no pairs
        for i in range(piece * n // 64, (piece + 1) * n // 64):
            u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
            xx = yy = zz = xy = xz = yz = real(0)
            for k in range(np.uint64(neighbour_count[i])):
                j = np.uint64(neighbour_index[i, k])
                u, v, w = velocity[0, j] - u_i, velocity[1, j] - v_i, velocity[2, j] - w_i
                gx, gy, gz = pair_gradient[0, i, k], pair_gradient[1, i, k], pair_gradient[2, i, k]
                xx += u * gx
                yy += v * gy
                zz += w * gz
                xy += u * gy + v * gx
                xz += u * gz + w * gx
                yz += v * gz + w * gy
            shear_rate[i] = math.sqrt(real(2) * (xx * xx + yy * yy + zz * zz) + xy * xy + xz * xz + yz * yz)


@cpu_stage
def viscosity(phase, temperature, shear_rate, viscous, viscosity):
    """See `melt.reference.viscosity_law.viscosity`."""
    real = type(viscous.mu)
    n = phase.shape[0]
    warm, thin = temperature.shape[0] > 0, shear_rate.shape[0] > 0
    for share in prange(64):  # fixed shares: a vectorised power and that of a loop's rest may round apart
        for i in range(share * n // 64, (share + 1) * n // 64):
            if phase[i] != LIQUID:
                viscosity[i] = real(0)
                continue
            mu = thermal_viscosity(temperature[i], viscous) if warm else viscous.mu
            mu = apparent_viscosity(mu, shear_rate[i], viscous) if thin else mu
            viscosity[i] = capped(mu, viscous)
