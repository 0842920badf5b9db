"""CUDA twin of `melt.reference.heat_source`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.heat import absorb, heater_contains, latent_heat


@cuda_kernel
def _heat_source(
    position, heat_volume, heater_shape, heater_centre, heater_size, heater_mode, heater_value,
    heater_reach, heat_capacity_molten, latent_point, latent_capacity, heat, dt,
    temperature, latent_energy, heat_capacity,
):
    i = cuda.grid(1)
    if i >= heat_volume.shape[0]:
        return
    real = type(heat.spacing)
    inf = real(math.inf)
    if heat_volume[i] == real(0):
        return
    for h in range(heater_shape.shape[0]):
        x = real(position[0, i] - heater_centre[0, h])
        y = real(position[1, i] - heater_centre[1, h])
        z = real(position[2, i] - heater_centre[2, h])
        if not heater_contains(
            x, y, z, heater_size[0, h], heater_size[1, h], heater_size[2, h],
            heater_shape[h], heater_reach[h],
        ):
            continue
        if heater_mode[h] == 1:
            temperature[i] = heater_value[h]
            heat_capacity[i] = inf
            if heat.latent != 0 and latent_capacity[i] > real(0):
                latent_energy[i] = latent_capacity[i] if heater_value[h] >= latent_point[i] else real(0)
            continue
        q = heater_value[h] * heat_volume[i] * dt
        if heat.latent != 0:
            T, e = absorb(
                q, temperature[i], latent_energy[i], latent_point[i], heat_capacity[i],
                heat_capacity_molten[i], latent_capacity[i],
            )
            temperature[i] = T
            latent_energy[i] = e
        else:
            temperature[i] += q / heat_capacity[i]


def heat_source(
    position, heat_volume, heater_shape, heater_centre, heater_size, heater_mode, heater_value,
    heater_reach, heat_capacity_molten, latent_point, latent_capacity, heat, dt,
    temperature, latent_energy, heat_capacity,
):
    """See `melt.reference.heat_source.heat_source`."""
    _heat_source.launch(
        heat_volume.shape[0], position, heat_volume, heater_shape, heater_centre, heater_size, heater_mode,
        heater_value, heater_reach, heat_capacity_molten, latent_point, latent_capacity, heat, dt,
        temperature, latent_energy, heat_capacity,
    )


@cuda_kernel
def _ambient_cooling(
    surface, neighbour_count, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, heat, dt, temperature, latent_energy,
):
    i = cuda.grid(1)
    if i >= surface.shape[0]:
        return
    real = type(heat.spacing)
    inf = real(math.inf)
    if surface[i] == 0 or heat_volume[i] == real(0):
        return
    bare = max(real(0), real(1) - real(neighbour_count[i]) / heat.full_neighbours)
    g = dt * heat.ambient_transfer * heat.ambient_area * heat.spacing * heat.spacing * bare
    air = heat.ambient_temperature
    T, C = temperature[i], heat_capacity[i]
    if g == real(0) or T == air:
        return
    if heat.latent == 0:
        temperature[i] = T + (air - T) * g / (C + g)  # C = inf keeps T: g / inf = 0
        return
    e, m, molten, L = latent_energy[i], latent_point[i], heat_capacity_molten[i], latent_capacity[i]
    zero, one = real(0), real(1)
    if T < air:
        q = latent_heat(g, T, e, m, C, molten, L, air, zero, inf, inf, one, zero)
    else:
        q = -latent_heat(g, air, zero, inf, inf, one, zero, T, e, m, C, molten, L)
    T, e = absorb(q, T, e, m, C, molten, L)
    temperature[i] = T
    latent_energy[i] = e


def ambient_cooling(
    surface, neighbour_count, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, heat, dt, temperature, latent_energy,
):
    """See `melt.reference.heat_source.ambient_cooling`."""
    _ambient_cooling.launch(
        surface.shape[0], surface, neighbour_count, heat_volume, heat_capacity, heat_capacity_molten,
        latent_point, latent_capacity, heat, dt, temperature, latent_energy,
    )
