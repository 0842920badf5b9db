r"""Thermal properties of particles. Melting paper eq (4), spec 2.5 and 3.5.

The pair law of all solvers is G_ij = kappa_ij V_i V_j L_ij between capacities C_i.
Paper law: kappa = K_i + K_j, C = V. Physical law: kappa = 2 k_i k_j / (k_i + k_j), C = m c.
V = 0 insulates a particle, C = inf fixes its temperature.
"""

import numpy as np


def thermal_properties(
    phase, material, mass, rest_volume, volume, density, material_conductivity,
    material_specific_heat, heat, conductivity, heat_volume, heat_capacity,
):
    """Write k, V and C of every particle.

    Reads: phase, material (n,), mass (n,) [kg], rest_volume, volume (n,) [m^3], density (n,)
        [kg/m^3]; material_conductivity [W/(m K)] (K [m^2/s] in paper mode),
        material_specific_heat [J/(kg K)].
    Writes: conductivity (n,), heat_volume (n,) [m^3], heat_capacity (n,) [J/K]. Inactive slots and
        (unless ``heat.wall_fixed``) walls have V = 0; fixed walls have C = inf.
    """
    wall, inactive, liquid = phase == 2, phase == 5, phase == 0
    m = np.where(inactive, 0.0, mass.astype(np.float64))
    V0 = np.where(inactive, 0.0, rest_volume.astype(np.float64))
    V = V0
    if heat.current_volume:  # the paper's V = m/rho of liquids, V_k^t of solids
        flowing = m / np.where(liquid & (density > 0), density, 1.0)
        V = np.where(liquid, flowing, np.where(inactive | wall, V0, volume))
    C = V if heat.law == 0 else m * material_specific_heat[material].astype(np.float64)
    conductivity[:] = np.where(inactive, 0.0, material_conductivity[material])
    heat_volume[:] = np.where(wall & (heat.wall_fixed == 0), 0.0, V)
    heat_capacity[:] = np.where(wall & (heat.wall_fixed != 0), np.inf, C)


def latent_properties(
    phase, material, mass, heat_volume, material_specific_heat, material_latent_heat,
    material_melting_point, material_melts_to, material_freezes_to, heat,
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy,
):
    """Write what a particle's enthalpy needs, and bring (T, latent energy) onto its curve.

    A solid melts at its own material's point, into ``melts_to``; a liquid freezes at the
    point of ``freezes_to`` (-1: never). Below the point the solid's specific heat holds, above
    it the liquid's, so the enthalpy is continuous through melting. In paper mode C = V on
    both sides and the latent capacity is V L / c of the solid's material [K m^3].

    Reads: see `thermal_properties`; material_latent_heat [J/kg], material_melting_point [degC].
    Writes: heat_capacity, heat_capacity_molten (n,) [J/K], latent_point (n,) [degC] (inf: no change),
        latent_capacity (n,) [J]; temperature and latent_energy of particles off their curve (a
        solid above its point with latent heat missing, a liquid below it with some left): the
        enthalpy is kept. More latent energy than the capacity (the mass changed) is dropped.
    """
    solid, liquid = phase == 1, phase == 0
    frozen = np.where(solid, material, np.where(liquid, material_freezes_to[material], -1))
    has = frozen >= 0
    frozen = np.where(has, frozen, 0)
    molten = np.where(solid, material_melts_to[np.where(solid, material, 0)], material)
    molten = np.where(molten >= 0, molten, material)
    c_s, c_l = material_specific_heat[frozen].astype(float), material_specific_heat[molten].astype(float)
    m, V = mass.astype(float), heat_volume.astype(float)
    latent = m * material_latent_heat[frozen]
    if heat.law == 0:
        latent = V * material_latent_heat[frozen] / np.where(c_s > 0, c_s, np.inf)
    point = material_melting_point[frozen].astype(float)
    has = has & np.isfinite(point) & (latent > 0)
    if heat.law != 0:
        heat_capacity[:] = np.where(has, m * c_s, heat_capacity)
    C = heat_capacity.astype(float)
    C_molten = np.where(has & (heat.law != 0), m * c_l, C)
    heat_capacity_molten[:] = C_molten
    latent_point[:] = np.where(has, point, np.inf)
    latent_capacity[:] = np.where(has, latent, 0.0)
    latent_energy[~has & np.isinf(latent_energy)] = 0.0
    for i in np.flatnonzero(has):
        T, e, top = float(temperature[i]), float(latent_energy[i]), float(latent[i])
        e = min(max(e, 0.0), top)
        if (T < point[i] and e > 0) or (T > point[i] and e < top):
            E = e + (C[i] if T < point[i] else C_molten[i]) * (T - point[i])
            e = min(max(E, 0.0), top)
            T = point[i] + min(E, 0.0) / C[i] + max(E - top, 0.0) / C_molten[i]
        temperature[i], latent_energy[i] = T, e


def latent_start(phase, latent_energy):
    """Write the latent energy of an initial state: inf in liquids (all that fits), 0 in others.

    `latent_properties` cuts it down to the latent capacity.
    """
    latent_energy[:] = np.where(phase == 0, np.inf, 0.0)
