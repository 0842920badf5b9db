"""Thermal fields of the check scene: materials, enthalpy states, heaters, conductances.

Conductivities are those of an imaginary world where a step of 1 ms moves heat noticeably (Fourier
number about 0.1): with real ones no temperature would change in float32 and nothing could fail.
"""

import numpy as np

from melt.check._cloud import INACTIVE, LIQUID, SOLID, SPACING, SUPPORT, WALL

#: density, conductivity, specific heat, melting point, latent heat, melts to, freezes to
MATERIALS = [
    (1000.0, 4e7, 4187.0, np.inf, 0.0, 0, 1),  # water
    (917.0, 9e7, 2100.0, 0.0, 3.34e4, 0, -1),  # ice
    (780.0, 1e7, 2000.0, np.inf, 0.0, 2, 3),  # liquid wax
    (900.0, 2e7, 2100.0, 40.0, 2e4, 2, -1),  # wax
    (2500.0, 6e7, 800.0, np.inf, 0.0, 4, -1),  # wall, never melts
    (1200.0, 0.0, 1500.0, np.inf, 0.0, 5, -1),  # an insulating liquid
]
PAPER = 1e-7  # paper mode: K [m^2/s] instead of k [W/(m K)], capacities in m^3 instead of J/K


def materials():
    """Return the material table by field name."""
    table = np.array([row[:5] for row in MATERIALS]).T
    names = ("density", "conductivity", "specific_heat", "melting_point", "latent_heat")
    fields = {f"material_{name}": column.copy() for name, column in zip(names, table)}
    fields["material_melts_to"] = np.array([row[5] for row in MATERIALS])
    fields["material_freezes_to"] = np.array([row[6] for row in MATERIALS])
    return fields


def temperatures(latent_point, phase, cold, rng):
    """Return temperature and share of latent heat of states on their enthalpy curve, all kinds mixed.

    Frozen below the point, frozen and half molten at it, molten at it, molten above it.
    """
    n = len(phase)
    changes = np.isfinite(latent_point)
    kind = np.where(cold, 1, rng.integers(0, 6, n))
    point = np.where(changes, latent_point, 0.0)
    offset = np.choose(kind, [-25.0, -0.75, 0.0, 0.0, 0.0, 12.0])
    share = np.choose(kind, [0.0, 0.0, 0.0, 0.4375, 1.0, 1.0])
    T = np.where(changes, point + offset, rng.uniform(-15, 80, n))
    return T, np.where(changes, share, 0.0)


def thermal_fields(phase, material, mass, rest_volume, cold, rng):
    """Return the fields of heat exchange as `thermal_properties` and `latent_properties` leave them."""
    table = materials()
    solid, liquid = phase == SOLID, phase == LIQUID
    frozen = np.where(solid, material, np.where(liquid, table["material_freezes_to"][material], -1))
    latent = np.where(frozen >= 0, mass * table["material_latent_heat"][frozen], 0.0)
    point = table["material_melting_point"][frozen]
    changes = (frozen >= 0) & np.isfinite(point) & (latent > 0)
    molten = np.where(solid, table["material_melts_to"][material], material)
    c = table["material_specific_heat"]
    capacity = mass * np.where(changes, c[frozen], c[material])
    latent_point = np.where(changes, point, np.inf)
    T, share = temperatures(latent_point, phase, cold, rng)
    exchanging = (phase != INACTIVE) & (phase != WALL)
    return dict(
        temperature=T,
        latent_point=latent_point,
        latent_capacity=np.where(changes, latent, 0.0),
        latent_energy=np.where(changes, latent * share, 0.0),
        heat_capacity=capacity,
        heat_capacity_molten=np.where(changes, mass * c[molten], capacity),
        conductivity=np.where(phase == INACTIVE, 0.0, table["material_conductivity"][material]),
        heat_volume=np.where(exchanging, rest_volume, 0.0),
        **table,
    )


def conductance(arrays):
    """Return G_ij [W/K] along the neighbour lists: harmonic mean and the viscosity Laplacian."""
    index = np.where(arrays["neighbour_index"] >= 0, arrays["neighbour_index"], 0)
    x, k, V = arrays["position"], arrays["conductivity"], arrays["heat_volume"]
    r = np.sqrt(((x[:, :, None] - x[:, index]) ** 2).sum(axis=0))
    L = 45 / (np.pi * SUPPORT**6) * np.maximum(SUPPORT - r, 0.0)
    total = k[:, None] + k[index]
    G = 2 * k[:, None] * k[index] / np.where(total > 0, total, 1) * V[:, None] * V[index] * L
    used = np.arange(index.shape[1])[None, :] < arrays["neighbour_count"][:, None]
    return np.where(used, G, 0.0)


def heaters():
    """A box and a sphere that heat, and a small box that holds its temperature; lengths are exact."""
    return dict(
        heater_shape=np.array([0, 1, 0]),
        heater_centre=np.array([[4.0, 4.0, 1.0], [5.0, 2.0, 4.0], [2.5, 1.5, 6.0]]).T * SPACING,
        heater_size=np.array([[2.0, 2.0, 1.0], [2.0, 0.0, 0.0], [1.5, 1.5, 1.0]]).T * SPACING,
        heater_mode=np.array([0, 0, 1]),
        heater_value=np.array([2e10, 3e10, 90.0]),
        heater_reach=np.array([0.0, 0.5, 0.25]) * SPACING,
    )


def in_paper_mode(arrays):
    """Return the arrays with the paper's units: K [m^2/s], C = V [m^3], latent heat in K m^3."""
    c = arrays["material_specific_heat"][arrays["material"]]
    volume = arrays["heat_volume"]
    per_mass = np.where(arrays["mass"] > 0, volume / np.where(arrays["mass"] > 0, arrays["mass"], 1) / c, 0.0)
    changed = {
        name: arrays[name] * PAPER for name in ("conductivity", "material_conductivity", "heat_conductance")
    }
    changed.update({name: arrays[name] * per_mass for name in ("latent_energy", "latent_capacity")})
    changed["heat_capacity"] = changed["heat_capacity_molten"] = volume + 0.0
    changed["heater_value"] = np.where(
        arrays["heater_mode"] == 0, arrays["heater_value"] * 2.5e-7, arrays["heater_value"]
    )
    return {**arrays, **changed}


def with_fixed_walls(arrays):
    """Return the arrays with walls that conduct and keep their temperature (C = inf)."""
    wall = arrays["phase"] == WALL
    return {
        **arrays,
        "heat_volume": np.where(wall, arrays["rest_volume"], arrays["heat_volume"]),
        "heat_capacity": np.where(wall, np.inf, arrays["heat_capacity"]),
    }
