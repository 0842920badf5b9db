"""Small scenes at the limits: a few particles in a box of 0.8 m, all with the same stages."""

import copy

import numpy as np

from melt.scene import scene_from_dict

DX = 0.2
BASE = {
    "time": {"end": 0.05, "output_every": 0.01},
    "domain": {"upper": [0.8, 0.8, 1.2], "spacing": DX},
    "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [0.8, 0.8, 0.4]}], "temperature": 40.0},
    "solid": [{"position": [0.4, 0.4, 0.6], "size": [0.4, 0.4, 0.4], "anchor": "base", "conductivity": 30}],
    "heat": {},
}
OPEN = {"walls": {"sides": ["none"]}}
WEIGHTLESS = {**OPEN, "gravity": [0, 0, 0]}
NO_LIQUID = {"fill": []}


def merged(base, changes):
    """Return nested dictionaries with ``changes`` put over ``base``; None removes a key."""
    result = copy.deepcopy(base)
    for key, value in changes.items():
        if value is None:
            result.pop(key, None)
        elif isinstance(value, dict) and isinstance(result.get(key), dict):
            result[key] = merged(result[key], value)
        else:
            result[key] = copy.deepcopy(value)
    return result


def scene(**sections):
    """Return the base scene with sections changed (dictionaries merge, lists replace, None removes)."""
    return scene_from_dict(merged(BASE, sections))


def box(lower, cells, **values):
    """Return a solid of ``cells`` lattice cells whose lower corner is cell ``lower``."""
    low = np.array(lower) * DX
    return {"lower": low.tolist(), "upper": (low + np.array(cells) * DX).tolist(), **values}


def fill(lower, cells, **values):
    """Return a liquid region, as `box`."""
    return {"fill": [box(lower, cells, **values)]}


def all_finite(sim):
    """Return whether everything that a frame would hold is finite."""
    return all(np.isfinite(values).all() for values in sim.frame().values())
