"""Particle, material and heater fields of the check scene. NumPy alone, apart from `melt._cloud`."""

import numpy as np

from melt.check._cloud import INACTIVE, LIQUID, MATERIALS, SOLID, SPACING, SUPPORT, WALL, body_cells


def _materials():
    table = np.array([row[:5] for row in MATERIALS]).T
    names = ("density", "conductivity", "specific_heat", "melting_point", "latent_heat")
    fields = {f"material_{name}": column.copy() for name, column in zip(names, table)}
    fields["material_melts_to"] = np.array([row[5] for row in MATERIALS])
    fields["material_freezes_to"] = np.array([row[6] for row in MATERIALS])
    return fields


def _material_of(phase, site, n, rng):
    """Water and liquid wax; ice and wax by body; walls."""
    body = np.concatenate([[b] * len(c) for b, c in enumerate(body_cells(n))] + [[]]).astype(int)
    material = np.where(rng.random(n) < 0.7, 0, 2)
    solid = phase == SOLID
    material[solid] = np.where(body[site[solid]] % 2 == 0, 1, 3)
    material[phase == WALL] = 4
    return material


def _density(arrays, mass, volume, rest_volume):
    """Number density of the cubic spline; enough for pressures of a plausible size."""
    count, index = arrays["neighbour_count"], arrays["neighbour_index"]
    n = len(mass)
    rho = mass / rest_volume
    x = arrays["position"]
    for i in np.flatnonzero(arrays["phase"] == LIQUID):
        j = index[i, : count[i]]
        q = np.sqrt(((x[:, j] - x[:, i : i + 1]) ** 2).sum(axis=0)) / SUPPORT
        w = np.where(q <= 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * (1 - q) ** 3)
        rho[i] = mass[i] / volume[i] * 8 / (np.pi * SUPPORT**3) * (volume[i] + (volume[j] * w).sum())
    return rho[:n]


def particle_fields(arrays, scales, rng):
    """Return mechanical and thermal fields that fit positions, phases and neighbour lists."""
    phase, n = arrays["phase"], len(arrays["phase"])
    table = _materials()
    material = _material_of(phase, arrays["site"], n, rng)
    V = SPACING**3
    rest_volume = np.where(phase == LIQUID, V * rng.choice([1.0, 0.917, 1.05], n), V)
    mass = table["material_density"][material] * rest_volume
    volume = np.where(phase == LIQUID, V, np.where(phase == SOLID, 0.77 * V * rng.uniform(0.9, 1.2, n), V))
    density = _density(arrays, mass, volume, rest_volume)
    rho0 = table["material_density"][material]
    pressure = np.where(phase == LIQUID, np.maximum(0, rho0 * 400 / 7 * ((density / rho0) ** 7 - 1)), 0.0)
    melts = table["material_melting_point"][material]
    temperature = np.where(np.isfinite(melts), melts + rng.choice([-20.0, -1.0, 3.0, 30.0], n), rng.uniform(-15, 80, n))
    capacity = np.where(phase == SOLID, mass * table["material_latent_heat"][material], 0.0)
    # liquids that may freeze hold what their solid form would take to melt
    freezes = table["material_freezes_to"][material]
    solidifies = (phase == LIQUID) & (freezes >= 0)
    capacity[solidifies] = (mass * table["material_latent_heat"][freezes])[solidifies]
    fields = dict(
        material=material, mass=mass, rest_volume=rest_volume, volume=volume, density=density, pressure=pressure,
        velocity=rng.normal(size=(3, n)) * 0.5 * scales["speed"], force=rng.normal(size=(3, n)) * scales["force"],
        temperature=temperature, latent_capacity=capacity,
        latent_energy=capacity * rng.choice([0.0, 0.3, 0.999, 1.0], n),
        conductivity=table["material_conductivity"][material], heat_volume=rest_volume.copy(),
        heat_capacity=mass * table["material_specific_heat"][material],
        surface=(rng.random(n) < 0.3).astype(int) * (phase == LIQUID), **table,
    )
    for name in ("position", "velocity", "temperature"):
        fields[f"{name}_next"] = (fields[name] if name in fields else arrays[name]) + 0.0
    empty = np.flatnonzero(phase == INACTIVE)[::2]  # slots never used; the others hold stale values
    for name in ("mass", "rest_volume", "volume", "density", "heat_volume", "heat_capacity", "latent_capacity"):
        fields[name][empty] = 0.0
    return fields


def _heaters():
    """A box and a sphere that heat, and a small box that holds its temperature; lengths are exact."""
    return dict(
        heater_shape=np.array([0, 1, 0]),
        heater_centre=np.array([[4.0, 4.0, 1.0], [5.0, 2.0, 4.0], [2.5, 1.5, 6.0]]).T * SPACING,
        heater_size=np.array([[2.0, 2.0, 1.0], [2.0, 0.0, 0.0], [1.5, 1.5, 1.0]]).T * SPACING,
        heater_mode=np.array([0, 0, 1]),
        heater_value=np.array([3e6, 5e6, 90.0]),
    )


def _inflow(rng):
    """Two nozzles of 7 and 4 particles."""
    k = 11
    return dict(
        inflow_position=rng.uniform(0, 1, (3, k)), inflow_velocity=rng.normal(size=(3, k)),
        inflow_mass=rng.uniform(5, 8, k), inflow_volume=rng.uniform(0.005, 0.008, k),
        inflow_temperature=rng.uniform(20, 90, k), inflow_material=rng.integers(0, 3, k),
    )


def guard_pairs(arrays):
    """Return for each particle how many liquid-solid or liquid-wall pairs are closer than half a spacing."""
    x, phase = arrays["position"], arrays["phase"]
    n = len(phase)
    r2 = ((x[:, :, None] - x[:, None, :]) ** 2).sum(axis=0)
    liquid, hard = phase == LIQUID, (phase == SOLID) | (phase == WALL)
    pair = (liquid[:, None] & hard[None, :]) | (hard[:, None] & liquid[None, :])
    return (pair & (r2 < (0.5 * SPACING) ** 2) & ~np.eye(n, dtype=bool)).sum(axis=1)


def special_fields(arrays, grid, scales, rng):
    """Return fields that need sites or several others: guard pairs, scratch, tree, heaters, inflow."""
    n = len(arrays["phase"])
    cells = grid["nx"] * grid["ny"] * grid["nz"] + 2
    from melt.check._tree import left_balanced

    return dict(
        offenders=guard_pairs(arrays), chunk_sum=np.zeros(-(-max(n, cells) // 256), int), arrival=np.zeros(n, int),
        tree=left_balanced(arrays["position"]), tree_rank=np.zeros(n, int),
        motion_bounds=np.zeros((2, 64)), rest_sum=_rest_sum(arrays, scales), **_heaters(), **_inflow(rng),
    )


def _rest_sum(arrays, scales):
    """Sum of the cubic spline over the region at rest, itself included."""
    X0, region = arrays["site_rest"], arrays["site_region"]
    total = np.zeros(len(region))
    for r in np.flatnonzero(arrays["site_region_count"] > 0):
        member = region[r][region[r] >= 0]
        q = np.sqrt(((X0[:, member] - X0[:, r : r + 1]) ** 2).sum(axis=0)) / SUPPORT
        w = np.where(q <= 0.5, 6 * q**3 - 6 * q**2 + 1, np.where(q < 1, 2 * (1 - np.minimum(q, 1)) ** 3, 0))
        total[r] = 8 / (np.pi * SUPPORT**3) * w.sum()
    return total
