"""The same problem given otherwise: moved, turned, or in other units of length, time and mass."""

import copy

import numpy as np

#: Exponents of (mass, length, time) of every dimensioned key of `FREE` and its kin; keys of one name have one dimension.
DIMENSIONS = {
    "end": (0, 0, 1), "dt": (0, 0, 1), "nucleation_time": (0, 0, 1), "precision_time": (0, 0, 1), "yield_time": (0, 0, 1),
    "lower": (0, 1, 0), "upper": (0, 1, 0), "spacing": (0, 1, 0), "position": (0, 1, 0), "size": (0, 1, 0), "radius": (0, 1, 0),
    "reference_depth": (0, 1, 0), "depth": (0, 1, 0), "cell": (0, 1, 0), "centre": (0, 1, 0),
    "gravity": (0, 1, -2), "velocity": (0, 1, -1), "speed": (0, 1, -1), "top_speed": (0, 1, -1), "vorticity": (0, 1, -1),
    "density": (1, -3, 0), "mu": (1, -1, -1), "sigma": (1, 0, -2), "drag": (0, 0, -1), "xsph": (0, 0, -1), "rate": (0, 0, -1),
    "conductivity": (1, 1, -3), "specific_heat": (0, 2, -2), "latent_heat": (0, 2, -2), "discharge": (0, 3, -1),
    "diffusivity": (0, 2, -1), "boost_rate": (0, 0, -1), "boost_speed": (0, 1, -1), "transfer": (0, 0, -1), "half_size": (0, 1, 0),
    "gas_density": (1, -3, 0), "merge_age": (0, 0, 1), "push_time": (0, 0, 1),
    "modulus": (1, -1, -2), "relaxation": (0, 0, 1),
}
#: Keys that say where something is.
PLACES = ("lower", "upper", "position", "centre")


def _changed(value, change, key=None):
    """Return nested dictionaries with ``change(key, value)`` at every leaf; a list of numbers is a leaf."""
    if isinstance(value, dict):
        return {k: _changed(v, change, k) for k, v in value.items()}
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return [_changed(item, change, key) for item in value]
    return change(key, value)


def rescaled(data, mass=1.0, length=1.0, time=1.0):
    """Return a scene in which a metre, a second and a kilogram have become so many."""

    def change(key, value):
        if key not in DIMENSIONS or isinstance(value, str):
            return value
        of = DIMENSIONS[key]
        factor = mass ** of[0] * length ** of[1] * time ** of[2]
        return [factor * v for v in value] if isinstance(value, list) else factor * value

    return _changed(data, change)


def moved(data, shift):
    """Return a scene in which everything stands elsewhere; ``shift`` has as many components as its places."""

    def change(key, value):
        return [float(v + s) for v, s in zip(value, shift)] if key in PLACES and isinstance(value, list) else value

    return _changed(data, change)


def turned(data):
    """Return a scene turned by 90 degrees about the vertical: (x, y) becomes (-y, x)."""
    data = copy.deepcopy(data)

    def boxes(item):
        if isinstance(item, dict):
            if "lower" in item:
                (a, b, *low), (c, d, *high) = item["lower"], item["upper"]
                item["lower"], item["upper"] = [-d, a, *low], [-b, c, *high]
            for inner in item.values():
                boxes(inner)
        elif isinstance(item, list):
            for inner in item:
                boxes(inner)

    def change(key, value):
        if key == "size":
            return [value[1], value[0], *value[2:]]
        if key == "half_size":
            return value[::-1]
        if key in ("position", "velocity", "gravity", "centre", "direction") and isinstance(value, list):
            return [-value[1], value[0], *value[2:]]
        return value

    boxes(data)
    return _changed(data, change)


def quarter(x):
    """Return vectors (n, 2 or 3) turned by 90 degrees about the vertical."""
    return np.column_stack([-x[:, 1], x[:, 0], x[:, 2:]])


def permuted(initial, seed, phases):
    """Return an initial state whose particles of each phase stand in another order, each with the id it had."""
    initial = copy.deepcopy(initial)
    n, order, random = initial["id"].size, np.arange(initial["id"].size), np.random.default_rng(seed)
    for phase in phases:
        there = np.flatnonzero(initial["phase"] == phase)
        order[there] = random.permutation(there)
    for name, values in initial.arrays.items():
        values = np.asarray(values)
        if values.ndim and values.shape[-1] == n and not name.startswith(("site", "inflow", "material", "nucleus", "apic")):
            initial.arrays[name] = np.ascontiguousarray(values[..., order])
    return initial
