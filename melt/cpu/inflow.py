"""CPU twin of `melt.reference.inflow`."""

import math

from melt._compile import cpu_stage, prange
from melt.physics.phases import LIQUID


@cpu_stage
def emit_motion(inflow_position, inflow_velocity, first, count, slot, lag, phase, position, velocity, latent_energy):
    """See `melt.reference.inflow.emit_motion`."""
    for k in prange(count):
        phase[slot + k] = LIQUID
        if latent_energy.shape[0] > 0:
            latent_energy[slot + k] = latent_energy.dtype.type(math.inf)
        for a in range(3):
            v = inflow_velocity[a, first + k]
            velocity[a, slot + k] = v
            position[a, slot + k] = inflow_position[a, first + k] + lag * v


@cpu_stage
def emit_matter(
    inflow_mass, inflow_volume, inflow_temperature, inflow_material, first, count, slot,
    mass, rest_volume, temperature, material, site,
):
    """See `melt.reference.inflow.emit_matter`."""
    for k in prange(count):
        mass[slot + k] = inflow_mass[first + k]
        rest_volume[slot + k] = inflow_volume[first + k]
        material[slot + k] = inflow_material[first + k]
        if site.shape[0] > 0:
            site[slot + k] = -1
        if temperature.shape[0] > 0:
            temperature[slot + k] = inflow_temperature[first + k]
