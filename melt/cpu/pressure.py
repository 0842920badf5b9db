"""CPU twin of `melt.reference.pressure`."""

from melt._compile import cpu_stage, prange
from melt.physics.eos import tait
from melt.physics.phases import LIQUID


@cpu_stage
def tait_pressure(phase, mass, volume, density, fluid, pressure):
    """See `melt.reference.pressure.tait_pressure`."""
    for i in prange(phase.shape[0]):
        if phase[i] == LIQUID:
            pressure[i] = tait(density[i], mass[i] / volume[i], fluid)
        else:
            pressure[i] = 0


@cpu_stage
def wall_pressure(phase, pressure, blend, wall_pressure):
    """See `melt.reference.pressure.wall_pressure`."""
    real = type(blend)
    for i in prange(phase.shape[0]):
        mean = wall_pressure[i]
        wall_pressure[i] = mean + blend * (pressure[i] - mean) if phase[i] == LIQUID else real(0)
