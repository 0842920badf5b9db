"""CPU twin of `melt.reference.heat_pairs`: serial, since the order is the method."""

from melt._compile import cpu_serial
from melt.physics.heat import exchange_factor, pair_latent
from melt.physics.phases import INACTIVE, WALL


@cpu_serial
def heat_pairs_seq(
    phase, heat_capacity, heat_capacity_molten, latent_point, latent_capacity, heat_conductance,
    neighbour_count, neighbour_index, heat, dt, temperature, latent_energy,
):
    """See `melt.reference.heat_pairs.heat_pairs_seq`."""
    real = type(dt)
    n = phase.shape[0]
    step = dt if heat.full_sweep != 0 else real(0.5) * dt
    for sweep in range(2):
        for place in range(n):
            i = place if sweep == 0 else n - 1 - place
            if phase[i] == WALL or phase[i] == INACTIVE:
                continue
            count = neighbour_count[i]
            for entry in range(count):
                slot = entry if sweep == 0 else count - 1 - entry
                j = neighbour_index[i, slot]
                if j < i and phase[j] != WALL:
                    continue
                g = step * heat_conductance[i, slot]
                if heat.latent == 0:
                    flow_i, flow_j = real(1) / heat_capacity[i], real(1) / heat_capacity[j]
                    q = exchange_factor(g, flow_i + flow_j) * (temperature[j] - temperature[i])
                    temperature[i] += q * flow_i
                    temperature[j] -= q * flow_j
                else:
                    T_i, e_i, T_j, e_j = pair_latent(
                        g, temperature[i], latent_energy[i], latent_point[i], heat_capacity[i],
                        heat_capacity_molten[i], latent_capacity[i], temperature[j], latent_energy[j],
                        latent_point[j], heat_capacity[j], heat_capacity_molten[j], latent_capacity[j],
                    )
                    temperature[i], latent_energy[i] = T_i, e_i
                    temperature[j], latent_energy[j] = T_j, e_j
