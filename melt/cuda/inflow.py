"""CUDA twin of `melt.reference.inflow`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID


@cuda_kernel
def _emit_motion(inflow_position, inflow_velocity, first, count, slot, lag, phase, position, velocity, latent_energy):
    k = cuda.grid(1)
    if k >= count:
        return
    phase[slot + k] = LIQUID
    if latent_energy.shape[0] > 0:
        latent_energy[slot + k] = latent_energy.dtype.type(math.inf)
    for a in range(3):
        v = inflow_velocity[a, first + k]
        velocity[a, slot + k] = v
        position[a, slot + k] = inflow_position[a, first + k] + lag * v


def emit_motion(inflow_position, inflow_velocity, first, count, slot, lag, phase, position, velocity, latent_energy):
    """See `melt.reference.inflow.emit_motion`."""
    _emit_motion.launch(
        count, inflow_position, inflow_velocity, first, count, slot, lag, phase, position, velocity, latent_energy
    )


@cuda_kernel
def _emit_matter(
    inflow_mass, inflow_volume, inflow_temperature, inflow_material, first, count, slot,
    mass, rest_volume, temperature, material, site,
):
    k = cuda.grid(1)
    if k >= count:
        return
    mass[slot + k] = inflow_mass[first + k]
    rest_volume[slot + k] = inflow_volume[first + k]
    material[slot + k] = inflow_material[first + k]
    if site.shape[0] > 0:
        site[slot + k] = -1
    if temperature.shape[0] > 0:
        temperature[slot + k] = inflow_temperature[first + k]


def emit_matter(
    inflow_mass, inflow_volume, inflow_temperature, inflow_material, first, count, slot,
    mass, rest_volume, temperature, material, site,
):
    """See `melt.reference.inflow.emit_matter`."""
    _emit_matter.launch(
        count, inflow_mass, inflow_volume, inflow_temperature, inflow_material, first, count, slot,
        mass, rest_volume, temperature, material, site,
    )
