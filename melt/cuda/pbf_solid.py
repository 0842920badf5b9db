"""CUDA twin of `melt.reference.pbf_solid`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.pbf import correction_factor, pair_scales
from melt.physics.phases import LIQUID, SOLID, WALL


@cuda_kernel
def _solid_correction(
    position, phase, mass, volume, multiplier, support_radius, kernel_scale, site, site_component, neighbour_count,
    neighbour_index, solid_index, solid_count, pbf, correction,
):
    a = cuda.grid(1)
    if a >= solid_count[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    tiny = real(1e-9) * pbf.spacing
    i = solid_index[a]
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    V_i, m_i = volume[i], mass[i]
    body = site_component[site[i]]
    scale = pbf.omega / m_i
    dx = dy = dz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        r2 = x * x + y * y + z * z
        f = real(0)
        if phase[j] == LIQUID:  # as the liquid sees the solid: a wall
            inverse, value, gradient = pair_scales(j, i, support_radius, kernel_scale, pbf)
            f = scale * correction_factor(r2, inverse, gradient, volume[j], multiplier[j], V_i, real(0), real(0), pbf)
        elif phase[j] == WALL or (phase[j] == SOLID and site_component[site[j]] != body):
            r = math.sqrt(r2)
            share = real(1) if phase[j] == WALL else mass[j] / (m_i + mass[j])
            f = share * real(0.5) * (pbf.spacing - r) / r if r > tiny and r < pbf.spacing else real(0)
        dx += f * x
        dy += f * y
        dz += f * z
    correction[0, i], correction[1, i], correction[2, i] = real(dx), real(dy), real(dz)


def solid_correction(
    position, phase, mass, volume, multiplier, support_radius, kernel_scale, site, site_component, neighbour_count,
    neighbour_index, solid_index, solid_count, pbf, correction,
):
    """See `melt.reference.pbf_solid.solid_correction`."""
    _solid_correction.launch(
        solid_index.shape[0], position, phase, mass, volume, multiplier, support_radius, kernel_scale, site, site_component,
        neighbour_count, neighbour_index, solid_index, solid_count, pbf, correction,
    )
