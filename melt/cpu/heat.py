"""CPU twin of `melt.reference.heat`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.params import HEAT_PAPER
from melt.physics.heat import absorb
from melt.physics.phases import INACTIVE, LIQUID, SOLID, WALL


@cpu_stage
def thermal_properties(
    phase, material, mass, rest_volume, volume, density, material_conductivity,
    material_specific_heat, heat, conductivity, heat_volume, heat_capacity,
):
    """See `melt.reference.heat.thermal_properties`."""
    real = type(heat.spacing)
    for i in prange(phase.shape[0]):
        kind = phase[i]
        if kind == INACTIVE:
            conductivity[i] = real(0)
            heat_volume[i] = real(0)
            heat_capacity[i] = real(0)
            continue
        V = rest_volume[i]
        if heat.current_volume != 0 and kind == LIQUID:
            V = mass[i] / (density[i] if density[i] > real(0) else real(1))
        elif heat.current_volume != 0 and kind != WALL:
            V = volume[i]
        C = V if heat.law == HEAT_PAPER else mass[i] * material_specific_heat[material[i]]
        insulated = kind == WALL and heat.wall_fixed == 0
        fixed = kind == WALL and heat.wall_fixed != 0
        conductivity[i] = material_conductivity[material[i]]
        heat_volume[i] = real(0) if insulated else V
        heat_capacity[i] = real(math.inf) if fixed else C


@cpu_stage
def latent_properties(
    phase, material, mass, heat_volume, material_specific_heat, material_latent_heat,
    material_melting_point, material_melts_to, material_freezes_to, heat,
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy,
):
    """See `melt.reference.heat.latent_properties`."""
    real = type(heat.spacing)
    for i in prange(phase.shape[0]):
        frozen = np.int32(-1)
        molten = np.int32(-1)
        if phase[i] == SOLID:
            frozen = material[i]
            molten = material_melts_to[frozen]
            if molten < 0:
                molten = frozen
        elif phase[i] == LIQUID:
            molten = material[i]
            frozen = material_freezes_to[molten]
        L = real(0)
        m = real(math.inf)
        if frozen >= 0:
            m = material_melting_point[frozen]
            if heat.law == HEAT_PAPER:
                c = material_specific_heat[frozen]
                L = heat_volume[i] * material_latent_heat[frozen] / c if c > real(0) else real(0)
            else:
                L = mass[i] * material_latent_heat[frozen]
        if not (L > real(0) and m < real(math.inf) and m > real(-math.inf)):
            heat_capacity_molten[i] = heat_capacity[i]
            latent_point[i] = real(math.inf)
            latent_capacity[i] = real(0)
            if latent_energy[i] == real(math.inf):  # from latent_start
                latent_energy[i] = real(0)
            continue
        C, C_molten = heat_capacity[i], heat_capacity[i]
        if heat.law != HEAT_PAPER:
            C = mass[i] * material_specific_heat[frozen]
            C_molten = mass[i] * material_specific_heat[molten]
        heat_capacity[i] = C
        heat_capacity_molten[i] = C_molten
        latent_point[i] = m
        latent_capacity[i] = L
        T = temperature[i]
        e = min(max(latent_energy[i], real(0)), L)
        if T < m and e > real(0):  # off the curve: put all enthalpy back onto it
            T, e = absorb((T - m) * C, m, e, m, C, C_molten, L)
        elif T > m and e < L:
            T, e = absorb((T - m) * C_molten, m, e, m, C, C_molten, L)
        temperature[i] = T
        latent_energy[i] = e


@cpu_stage
def latent_start(phase, latent_energy):
    """See `melt.reference.heat.latent_start`."""
    real = latent_energy.dtype.type
    for i in prange(phase.shape[0]):
        latent_energy[i] = real(math.inf) if phase[i] == LIQUID else real(0)
