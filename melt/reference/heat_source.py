"""Sources of heat: heaters and ambient air. Melting spec 2.5."""

import numpy as np

from melt.reference._enthalpy import Enthalpy


def heat_source(
    position, heat_volume, heater_shape, heater_centre, heater_size, heater_mode, heater_value,
    heater_reach, heat_capacity_molten, latent_point, latent_capacity, heat, dt,
    temperature, latent_energy, heat_capacity,
):
    """Heat particles inside a heater or within its reach; heaters act in the order of their rows.

    Mode 0 adds ``heater_value`` V dt (so K/s with the paper's C = V), mode 1 sets the
    temperature and fixes it for this step (C = inf).

    Reads: position (3, n) [m], heat_volume (n,) [m^3] (0: not heated), the heater table, the
        enthalpy fields of `melt.reference.heat.latent_properties`.
    Writes: temperature (n,) [degC], latent_energy (n,) [J], heat_capacity (n,) [J/K].
    """
    x = position.astype(np.float64)
    for h in range(len(heater_shape)):
        offset = x - heater_centre[:, h].astype(float)[:, None]
        size = heater_size[:, h].astype(float)
        if heater_shape[h] == 1:
            distance = np.sqrt((offset**2).sum(axis=0)) - size[0]
        else:
            distance = np.sqrt((np.maximum(np.abs(offset) - size[:, None], 0.0) ** 2).sum(axis=0))
        inside = (distance <= float(heater_reach[h])) & (heat_volume > 0)
        curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
        for i in np.flatnonzero(inside):
            e = float(latent_energy[i]) if heat.latent else 0.0
            if heater_mode[h] == 1:
                temperature[i] = heater_value[h]
                if heat.latent and latent_capacity[i] > 0:
                    latent_energy[i] = latent_capacity[i] if heater_value[h] >= latent_point[i] else 0.0
                heat_capacity[i] = np.inf
                continue
            q = float(heater_value[h]) * float(heat_volume[i]) * float(dt)
            temperature[i], e = curve.absorb(i, q, float(temperature[i]), e)
            if heat.latent:
                latent_energy[i] = e


def ambient_cooling(
    surface, neighbour_count, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, heat, dt, temperature, latent_energy,
):
    """Cool (or warm) free surfaces: C dT/dt = -h_c A (T - T_amb), implicit.

    T <- (T + b T_amb) / (1 + b), b = dt h_c A / C, A = k_A dx^2 max(0, 1 - N/N_full).

    Reads: surface, neighbour_count (n,), the enthalpy fields.
    Writes: temperature (n,) [degC], latent_energy (n,) [J] of surface particles.
    """
    n = len(surface)
    curve = Enthalpy(
        heat, np.append(heat_capacity, np.inf), np.append(heat_capacity_molten, np.inf),
        np.append(latent_point, np.inf), np.append(latent_capacity, 0.0),
    )
    for i in range(n):
        if surface[i] == 0 or heat_volume[i] == 0:
            continue
        bare = max(0.0, 1 - int(neighbour_count[i]) / float(heat.full_neighbours))
        A = float(heat.ambient_area) * float(heat.spacing) ** 2 * bare
        T = {i: float(temperature[i]), n: float(heat.ambient_temperature)}
        e = {i: float(latent_energy[i]) if heat.latent else 0.0, n: 0.0}
        curve.exchange(float(dt) * float(heat.ambient_transfer) * A, i, n, T, e)
        temperature[i] = T[i]
        if heat.latent:
            latent_energy[i] = e[i]
