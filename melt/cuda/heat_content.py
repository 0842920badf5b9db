"""CUDA twin of `melt.reference.heat_content`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.heat import add_compensated, enthalpy
from melt.physics.phases import LIQUID, SOLID


@cuda_kernel
def _heat_content(
    phase, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy, heat,
    heat_content,
):
    piece = cuda.grid(1)
    n, pieces = phase.shape[0], heat_content.shape[1]
    if piece >= pieces:
        return
    real = type(heat.spacing)
    wide = heat_content.dtype.type
    inf = real(math.inf)
    total, rest = wide(0), wide(0)
    for i in range(n * piece // pieces, n * (piece + 1) // pieces):
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


def heat_content(
    phase, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy, heat,
    heat_content,
):
    """See `melt.reference.heat_content.heat_content`."""
    _heat_content.launch(
        heat_content.shape[1], phase, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature,
        latent_energy, heat, heat_content,
    )
