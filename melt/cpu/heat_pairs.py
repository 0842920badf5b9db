"""CPU twin of `melt.reference.heat_pairs`: serial, since the order is the method."""

import math

from melt._compile import cpu_serial
from melt.physics.heat import pair_factor, pair_latent, pair_weight
from melt.physics.phases import INACTIVE, WALL


@cpu_serial
def heat_pairs_seq(
    position, phase, conductivity, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, neighbour_count, neighbour_index, smoothing, heat, dt, temperature, latent_energy,
):
    """See `melt.reference.heat_pairs.heat_pairs_seq`."""
    real = type(smoothing.support)
    n = phase.shape[0]
    step = dt if heat.full_sweep != 0 else real(0.5) * dt
    for sweep in range(2):
        for place in range(n):
            i = place if sweep == 0 else n - 1 - place
            if phase[i] == WALL or phase[i] == INACTIVE or heat_volume[i] == real(0):
                continue
            count = neighbour_count[i]
            for entry in range(count):
                j = neighbour_index[i, entry if sweep == 0 else count - 1 - entry]
                if (j < i and phase[j] != WALL) or heat_volume[j] == real(0):
                    continue
                x = real(position[0, i] - position[0, j])
                y = real(position[1, i] - position[1, j])
                z = real(position[2, i] - position[2, j])
                r = math.sqrt(x * x + y * y + z * z)
                w = pair_weight(r, heat_volume[i], heat_volume[j], step, smoothing)
                if heat.latent == 0:
                    flow_i, flow_j = real(1) / heat_capacity[i], real(1) / heat_capacity[j]
                    f = pair_factor(w, conductivity[i], conductivity[j], flow_i + flow_j, heat)
                    q = f * (temperature[j] - temperature[i])
                    temperature[i] += q * flow_i
                    temperature[j] -= q * flow_j
                else:
                    g = pair_factor(w, conductivity[i], conductivity[j], real(0), heat)
                    T_i, e_i, T_j, e_j = pair_latent(
                        g, temperature[i], latent_energy[i], latent_point[i], heat_capacity[i],
                        heat_capacity_molten[i], latent_capacity[i], temperature[j], latent_energy[j],
                        latent_point[j], heat_capacity[j], heat_capacity_molten[j], latent_capacity[j],
                    )
                    temperature[i], latent_energy[i] = T_i, e_i
                    temperature[j], latent_energy[j] = T_j, e_j
