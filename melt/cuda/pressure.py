"""CUDA twin of `melt.reference.pressure`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.eos import tait
from melt.physics.phases import LIQUID


@cuda_kernel
def _tait_pressure(phase, mass, volume, density, fluid, pressure):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] == LIQUID:
        pressure[i] = tait(density[i], mass[i] / volume[i], fluid)
    else:
        pressure[i] = 0


def tait_pressure(phase, mass, volume, density, fluid, pressure):
    """See `melt.reference.pressure.tait_pressure`."""
    _tait_pressure.launch(phase.shape[0], phase, mass, volume, density, fluid, pressure)


@cuda_kernel
def _wall_pressure(phase, pressure, blend, wall_pressure):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(blend)
    mean = wall_pressure[i]
    wall_pressure[i] = mean + blend * (pressure[i] - mean) if phase[i] == LIQUID else real(0)


def wall_pressure(phase, pressure, blend, wall_pressure):
    """See `melt.reference.pressure.wall_pressure`."""
    _wall_pressure.launch(phase.shape[0], phase, pressure, blend, wall_pressure)
