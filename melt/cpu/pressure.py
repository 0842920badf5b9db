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
