"""CPU twin of `melt.reference.vorticity`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.cpu._xsph import xsph_weight
from melt.physics.pbf import pair_scales, spiky_over_r, support_of
from melt.physics.phases import LIQUID, SOLID


@cpu_stage
def vorticity_curl(
    position, velocity, phase, volume, support_radius, kernel_scale, neighbour_count, neighbour_index, pbf,
    vorticity,
):
    """See `melt.reference.vorticity.vorticity_curl`."""
    real = type(pbf.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
        ox = oy = oz = wide(0)
        for k in range(np.uint64(neighbour_count[i] if phase[i] == LIQUID else 0)):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            inverse, value, gradient = pair_scales(i, j, support_radius, kernel_scale, pbf)
            f = volume[j] * spiky_over_r(x * x + y * y + z * z, inverse, gradient, pbf)
            f = f if phase[j] == LIQUID else real(0)
            u, v, w = velocity[0, j] - u_i, velocity[1, j] - v_i, velocity[2, j] - w_i
            ox += f * (v * z - w * y)  # (7): grad_pj W = f x_ij
            oy += f * (w * x - u * z)
            oz += f * (u * y - v * x)
        vorticity[0, i], vorticity[1, i], vorticity[2, i] = real(ox), real(oy), real(oz)


@cpu_stage
def vorticity_force(
    position, vorticity, phase, volume, support_radius, kernel_scale, neighbour_count, neighbour_index, pbf, dt,
    velocity,
):
    """See `melt.reference.vorticity.vorticity_force`."""
    real = type(pbf.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            continue
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        ox, oy, oz = vorticity[0, i], vorticity[1, i], vorticity[2, i]
        size = math.sqrt(ox * ox + oy * oy + oz * oz)
        ex = ey = ez = wide(0)
        for k in range(np.uint64(neighbour_count[i])):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            inverse, value, gradient = pair_scales(i, j, support_radius, kernel_scale, pbf)
            p, q, r = vorticity[0, j], vorticity[1, j], vorticity[2, j]
            f = volume[j] * (math.sqrt(p * p + q * q + r * r) - size)
            f = f * spiky_over_r(x * x + y * y + z * z, inverse, gradient, pbf)
            f = f if phase[j] == LIQUID else real(0)
            ex -= f * x
            ey -= f * y
            ez -= f * z
        nx, ny, nz = real(ex), real(ey), real(ez)
        floor = real(1e-9) / (pbf.support * dt)
        push = dt * pbf.vorticity / (math.sqrt(nx * nx + ny * ny + nz * nz) + floor)
        velocity[0, i] += push * (ny * oz - nz * oy)
        velocity[1, i] += push * (nz * ox - nx * oz)
        velocity[2, i] += push * (nx * oy - ny * ox)


@cpu_stage
def pbf_xsph(
    position, velocity, phase, mass, volume, support_radius, neighbour_count, neighbour_index, pbf, dt,
    velocity_next,
):
    """See `melt.reference.vorticity.pbf_xsph`."""
    real = type(pbf.support)
    wide = position.dtype.type
    c = min(real(0.5), pbf.blend * dt)
    for i in prange(phase.shape[0]):
        x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
        u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
        m_i, V_i = mass[i], volume[i]
        du = dv = dw = wide(0)
        for k in range(np.uint64(neighbour_count[i] if phase[i] <= SOLID else 0)):
            j = np.uint64(neighbour_index[i, k])
            x = real(x_i - position[0, j])
            y = real(y_i - position[1, j])
            z = real(z_i - position[2, j])
            inverse = real(1) / support_of(i, j, support_radius, pbf)
            f = xsph_weight(x * x + y * y + z * z, inverse, m_i, mass[j], V_i, volume[j])
            f = f if phase[i] + phase[j] <= SOLID else real(0)  # not of two solids
            du += f * (velocity[0, j] - u_i)
            dv += f * (velocity[1, j] - v_i)
            dw += f * (velocity[2, j] - w_i)
        velocity_next[0, i] = u_i + c * real(du)
        velocity_next[1, i] = v_i + c * real(dv)
        velocity_next[2, i] = w_i + c * real(dw)
