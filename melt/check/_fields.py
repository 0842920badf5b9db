"""Particle fields of the check scene. NumPy and the sibling files of this folder alone."""

import numpy as np

from melt.check._cloud import INACTIVE, LIQUID, QUANTUM, SOLID, SPACING, SUPPORT, WALL, body_cells, quantise
from melt.check._thermal import conductance, heaters, materials, thermal_fields
from melt.check._tree import left_balanced


def _material_of(phase, site, n, rng):
    """Water, liquid wax and a liquid that insulates; ice and wax by body; walls."""
    body = np.concatenate([[b] * len(c) for b, c in enumerate(body_cells(n))] + [[]]).astype(int)
    material = rng.choice([0, 2, 5], n, p=[0.6, 0.3, 0.1])
    solid = phase == SOLID
    material[solid] = np.where(body[site[solid]] % 2 == 0, 1, 3)
    material[phase == WALL] = 4
    melted = (phase == LIQUID) & (site >= 0)
    material[melted] = np.where(body[site[melted]] % 2 == 0, 0, 2)
    return material


def _spline(q):
    """The cubic spline, of unit integral times 8 / (pi h^3)."""
    return (
        np.where(q <= 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * np.maximum(1 - q, 0) ** 3) * 8 / (np.pi * SUPPORT**3)
    )


def _density(arrays, mass, volume, rest_volume):
    """Number density of the cubic spline; enough for pressures of a plausible size."""
    count, index = arrays["neighbour_count"], arrays["neighbour_index"]
    rho = mass / rest_volume
    x = arrays["position"]
    for i in np.flatnonzero(arrays["phase"] == LIQUID):
        j = index[i, : count[i]]
        r = np.sqrt(((x[:, j] - x[:, i : i + 1]) ** 2).sum(axis=0))
        rho[i] = mass[i] / volume[i] * (volume[i] * _spline(0.0) + (volume[j] * _spline(r / SUPPORT)).sum())
    return rho


def particle_fields(arrays, scales, rng):
    """Return mechanical and thermal fields that fit positions, phases and neighbour lists."""
    phase, n = arrays["phase"], len(arrays["phase"])
    material = _material_of(phase, arrays["site"], n, rng)
    cold = freezing_candidates(arrays)
    material[cold] = np.where(material[cold] == 2, 2, 0)
    V = SPACING**3
    rho0 = materials()["material_density"][material]
    rest_volume = np.where(phase == LIQUID, V * rng.choice([1.0, 0.917, 1.05], n), V)
    mass = rho0 * rest_volume
    volume = np.where(phase == LIQUID, V, np.where(phase == SOLID, 0.77 * V * rng.uniform(0.9, 1.2, n), V))
    density = _density(arrays, mass, volume, rest_volume)
    pressure = np.where(phase == LIQUID, np.maximum(0, rho0 * 400 / 7 * ((density / rho0) ** 7 - 1)), 0.0)
    fields = dict(
        material=material,
        mass=mass,
        rest_volume=rest_volume,
        volume=volume,
        density=density,
        pressure=pressure,
        velocity=rng.normal(size=(3, n)) * 0.5 * scales["speed"],
        force=rng.normal(size=(3, n)) * scales["force"],
        surface=(rng.random(n) < 0.3).astype(int) * (phase == LIQUID),
        **thermal_fields(phase, material, mass, rest_volume, cold, rng),
    )
    fields["velocity"][:, cold] *= 0.25  # slow enough to freeze
    fields["heat_conductance"] = conductance({**arrays, **fields})
    for name in ("position", "velocity"):
        fields[f"{name}_next"] = (fields[name] if name in fields else arrays[name]) + 0.0
    fields["temperature_next"] = fields["temperature"] + rng.normal(size=n)
    empty = np.flatnonzero(phase == INACTIVE)[::2]  # slots never used; the others hold stale values
    for name in (
        "mass",
        "rest_volume",
        "volume",
        "density",
        "heat_capacity",
        "heat_capacity_molten",
        "latent_capacity",
    ):
        fields[name][empty] = 0.0
    return fields


def freezing_candidates(arrays):
    """Return which liquid particles are close to where one melted from its body."""
    x, liquid = arrays["position"], arrays["phase"] == LIQUID
    near = np.zeros(len(liquid), bool)
    for i in np.flatnonzero(liquid & (arrays["site"] >= 0)):
        near |= ((x - x[:, i : i + 1]) ** 2).sum(axis=0) < (0.5 * SPACING) ** 2
    return near & liquid


def freezing_fields(arrays):
    """Return choices and claims of vacant sites that fit lists and sites; distances tie on purpose."""
    x, n = arrays["position"], len(arrays["phase"])
    choice, distance = np.full(n, -1), np.zeros(n, int)
    home = np.flatnonzero((arrays["phase"] == LIQUID) & (arrays["site"] >= 0))
    for i in np.flatnonzero(freezing_candidates(arrays)):
        row = arrays["neighbour_index"][i, : arrays["neighbour_count"][i]]
        hosts = {int(s) for s in arrays["site"][row[arrays["phase"][row] == SOLID]]}
        for h in home:
            s = arrays["site"][h]
            if hosts & set(arrays["site_adjacent"][s]):
                far = np.sqrt(((x[:, i] - x[:, h]) ** 2).sum()) / (0.6 * SPACING)
                if far < 1 and (choice[i] < 0 or far * 8 < distance[i]):
                    choice[i], distance[i] = s, int(far * 8)
    claim = np.full(len(arrays["site_body"]), -1)
    for i in np.flatnonzero(choice >= 0):
        best = claim[choice[i]]
        if best < 0 or (distance[i], arrays["id"][i]) < (distance[best], arrays["id"][best]):
            claim[choice[i]] = i
    return dict(freeze_site=choice, freeze_distance=distance, claim=claim)


def nucleation_fields(arrays):
    """Return more particles that would start a body than there are free ones: of four, two have live sites."""
    n, sites = len(arrays["phase"]), len(arrays["site_body"])
    liquid, number = arrays["phase"] == LIQUID, np.arange(n)
    spare = np.array([[0, sites - 3, 3, sites - 6], [3, sites, 9, sites - 3]]) if sites else np.zeros((2, 0), int)
    starts = liquid & (number % 23 == 3)
    return dict(nucleation=np.where(starts, 3, liquid & (number % 7 == 0)), nucleus_sites=spare)


def _inflow(rng):
    """Two nozzles of 7 and 4 particles."""
    k = 11
    return dict(
        inflow_position=rng.uniform(0, 1, (3, k)),
        inflow_velocity=rng.normal(size=(3, k)),
        inflow_mass=rng.uniform(5, 8, k),
        inflow_volume=rng.uniform(0.005, 0.008, k),
        inflow_temperature=rng.uniform(20, 90, k),
        inflow_material=rng.integers(0, 3, k),
    )


def guard_pairs(arrays):
    """Return for each particle how many liquid-solid or liquid-wall pairs are closer than half a spacing."""
    x, phase = arrays["position"], arrays["phase"]
    r2 = ((x[:, :, None] - x[:, None, :]) ** 2).sum(axis=0)
    liquid, hard = phase == LIQUID, (phase == SOLID) | (phase == WALL)
    pair = (liquid[:, None] & hard[None, :]) | (hard[:, None] & liquid[None, :])
    return (pair & (r2 < (0.5 * SPACING) ** 2)).sum(axis=1)


def _rest_sum(arrays):
    """Sum of the cubic spline over the region at rest, itself included."""
    X0, region = arrays["site_rest"], arrays["site_region"]
    total = np.zeros(len(region))
    for r in np.flatnonzero(arrays["site_region_count"] > 0):
        member = region[r][region[r] >= 0]
        total[r] = _spline(np.sqrt(((X0[:, member] - X0[:, r : r + 1]) ** 2).sum(axis=0)) / SUPPORT).sum()
    return total


def surface_nodes(arrays):
    """Points for the surface field: at particles, exactly at the reach of a lonely one, between, far away."""
    rng = np.random.default_rng(11)
    x = arrays["position"]
    if x.shape[1] == 0:
        return np.zeros((3, 5)) + np.arange(5)
    near = x[:, rng.integers(0, x.shape[1], 200)] + quantise(rng.uniform(-0.3, 0.3, (3, 200)))
    far = np.full((3, 1), 40 * SPACING)
    edge = far + np.array([[2 * SPACING, 0, QUANTUM - 2 * SPACING], [0, -2 * SPACING, 0], [0, 0, 0]])
    return np.concatenate([x[:, ::3], near, far, edge, far + 9, -far], axis=1)


def special_fields(arrays, rng):
    """Return fields that need sites or several others: guard pairs, tree, sums at rest, heaters, inflow."""
    return dict(
        offenders=guard_pairs(arrays),
        tree=left_balanced(arrays["position"]),
        rest_sum=_rest_sum(arrays),
        surface_node=surface_nodes(arrays),
        **freezing_fields(arrays),
        **nucleation_fields(arrays),
        **heaters(),
        **_inflow(rng),
    )
