"""CPU twin of `melt.reference.heat_content`."""

import math

from melt._compile import cpu_stage, prange
from melt.physics.heat import add_compensated, enthalpy
from melt.physics.phases import LIQUID, SOLID

PIECES = 64


@cpu_stage
def heat_content(
    phase, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy, heat,
    heat_content,
):
    """See `melt.reference.heat_content.heat_content`."""
    real = type(heat.spacing)
    wide = heat_content.dtype.type
    inf = real(math.inf)
    n = phase.shape[0]
    for piece in prange(PIECES):
        total, rest = wide(0), wide(0)
        for i in range(n * piece // PIECES, n * (piece + 1) // PIECES):
            if (phase[i] != LIQUID and phase[i] != SOLID) or heat_capacity[i] == inf:
                continue
            e = heat_capacity[i] * temperature[i]
            if heat.latent != 0:
                e = enthalpy(
                    temperature[i], latent_energy[i], latent_point[i], heat_capacity[i], heat_capacity_molten[i],
                    latent_capacity[i],
                )
            total, rest = add_compensated(total, rest, wide(e))
        heat_content[0, piece] = total
        heat_content[1, piece] = rest
