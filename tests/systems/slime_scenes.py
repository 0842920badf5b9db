"""Small incompressible scenes: a square of 36 liquid nodes in the open, in two dimensions and double precision."""

import numpy as np
from extreme_scenes import merged

from melt.scene import scene_from_dict

D, RHO = 0.1, 1000.0
BASE = {
    "time": {"end": 1.0, "dt": 0.01, "output_every": 0.05, "n_sub_max": 64},
    "domain": {
        "lower": [-1.2, 0.0, -1.2], "upper": [1.2, 0.0, 1.2], "spacing": D, "gravity": [0, 0, 0], "dimensions": 2,
        "walls": {"sides": ["none"]},
    },
    "fluid": {"fill": [{"lower": [-0.3, -1.0, -0.3], "upper": [0.3, 1.0, 0.3]}]},
    "solver": {"pressure": "hybrid", "precision": "double", "apic": {}, "ghosts": {}},
}
TURNING = {"flow": {"kind": "rotation", "rate": 1.0}}
BASIN = {"domain": {"lower": [-0.6, 0.0, 0.0], "gravity": [0, 0, -9.81], "upper": [0.6, 0.0, 1.2], "walls": {"sides": ["x-", "x+", "z-"]}}}


def pool(**changes):
    """Water at rest, 12 x 6 nodes in a basin: changes as `slime`."""
    return slime(**merged({**BASIN, "fluid": {"fill": [{"lower": [-0.6, -1.0, 0.0], "upper": [0.6, 1.0, 0.6]}]}}, changes))


def slime(**sections):
    """Return the base scene with sections changed (dictionaries merge, lists replace, None removes)."""
    return scene_from_dict(merged(BASE, sections))


def square(low, cells, **values):
    """Return a fill of ``cells`` (x, z) nodes whose lower corner is node ``low``."""
    low = np.array([low[0], 0.0, low[1]]) * D
    high = low + np.array([cells[0], 0.0, cells[1]]) * D
    return {"lower": [float(low[0]), -1.0, float(low[2])], "upper": [float(high[0]), 1.0, float(high[2])], **values}


def sound(sim):
    """Hold that all is finite and mass is kept; return the ledgers."""
    s = sim.series()
    assert all(np.isfinite(values).all() for values in sim.frame().values())
    assert all(np.isfinite(value) for value in s.values())
    assert abs(s["mass_created"]) <= 1e-12 * max(s["mass"], s["mass_deleted"], 1.0)
    return s


def liquid(sim, name):
    """Return a field of the liquid in order of id."""
    return sim.read(name)[sim.read("phase") == 0]


def carriers(sim, *names):
    """Return fields of the APIC particles that are there, in order of their ids."""
    there = sim.state.read("apic_phase") == 0
    rank = np.argsort(sim.state.read("apic_id")[there])
    return [sim.state.read(name)[..., there][..., rank] for name in names]  # component first


def linear(sim):
    """Return the linear fit of the liquid's velocity in the plane: gradient (2, 2), and how far it is off [m/s]."""
    x, v = liquid(sim, "position")[:, [0, 2]], liquid(sim, "velocity")[:, [0, 2]]
    A = np.column_stack([x, np.ones(len(x))])
    fit = np.linalg.lstsq(A, v, rcond=None)[0]
    return fit[:2].T, np.abs(v - A @ fit).max()
