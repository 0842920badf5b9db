"""CUDA twin of `melt.reference.volume`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.params import VOLUME_SHELL
from melt.physics.phases import DRIVEN, LIQUID, SOLID, WALL
from melt.physics.smoothing import W


@cuda_kernel
def _liquid_volume(phase, rest_volume, fluid, volume):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] == LIQUID and fluid.number_density == 1:
        volume[i] = fluid.minimum_volume
    elif phase[i] <= WALL or phase[i] == DRIVEN:
        volume[i] = rest_volume[i]
    else:
        volume[i] = 0


def liquid_volume(phase, rest_volume, fluid, volume):
    """See `melt.reference.volume.liquid_volume`."""
    _liquid_volume.launch(phase.shape[0], phase, rest_volume, fluid, volume)


@cuda_kernel
def _rest_sum(site_rest, site_region, site_region_count, smoothing, rest_sum):
    s = cuda.grid(1)
    if s >= site_region_count.shape[0]:
        return
    real = type(smoothing.support)
    total = real(0)
    if site_region_count[s] > 0:
        x_s, y_s, z_s = site_rest[0, s], site_rest[1, s], site_rest[2, s]
        for k in range(site_region.shape[1]):
            member = site_region[s, k]
            q = member if member >= 0 else s
            x = x_s - site_rest[0, q]
            y = y_s - site_rest[1, q]
            z = z_s - site_rest[2, q]
            w = W(math.sqrt(x * x + y * y + z * z), smoothing)
            total += w if member >= 0 else real(0)
    rest_sum[s] = total


def rest_sum(site_rest, site_region, site_region_count, smoothing, rest_sum):
    """See `melt.reference.volume.rest_sum`."""
    _rest_sum.launch(
        site_region_count.shape[0], site_rest, site_region, site_region_count, smoothing, rest_sum,
    )


@cuda_kernel
def _solid_volume_rest(
    position, rest_volume, site_particle, site_region, site_region_count, rest_sum,
    smoothing, lattice, volume,
):
    s = cuda.grid(1)
    if s >= site_particle.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if site_particle[s] < 0 or site_region_count[s] == 0:
        return
    i = site_particle[s]
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    total = wide(0)
    for k in range(site_region.shape[1]):
        member = site_region[s, k]
        j = site_particle[member if member >= 0 else s]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        w = W(math.sqrt(x * x + y * y + z * z), smoothing)
        total += w if member >= 0 else real(0)
    volume[i] = lattice.solid_scale * rest_volume[i] * rest_sum[s] / real(total)


def solid_volume_rest(
    position, rest_volume, site_particle, site_region, site_region_count, rest_sum,
    smoothing, lattice, volume,
):
    """See `melt.reference.volume.solid_volume_rest`."""
    _solid_volume_rest.launch(
        site_particle.shape[0], position, rest_volume, site_particle, site_region, site_region_count,
        rest_sum, smoothing, lattice, volume,
    )


@cuda_kernel
def _solid_volume_akinci(
    position, phase, site, site_component, site_link_count, neighbour_count, neighbour_index,
    smoothing, lattice, volume,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    # live links, its own counted, of a site that counts: fewer
    inside = lattice.connect + 1 if lattice.solid_volume == VOLUME_SHELL else 28
    if phase[i] != SOLID:
        return
    s = site[i]
    if site_link_count[s] >= inside:
        volume[i] = 0
        return
    own = site_component[s]
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    total = wide(W(real(0), smoothing))
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        w = W(math.sqrt(x * x + y * y + z * z), smoothing)
        solid = phase[j] == SOLID
        t = site[j] if solid else site[i]  # a legal site to look at in any case
        counts = solid & (site_component[t] == own) & (site_link_count[t] < inside)
        total += w if counts else real(0)
    volume[i] = lattice.solid_scale / real(total)


def solid_volume_akinci(
    position, phase, site, site_component, site_link_count, neighbour_count, neighbour_index,
    smoothing, lattice, volume,
):
    """See `melt.reference.volume.solid_volume_akinci`."""
    _solid_volume_akinci.launch(
        phase.shape[0], position, phase, site, site_component, site_link_count, neighbour_count,
        neighbour_index, smoothing, lattice, volume,
    )
