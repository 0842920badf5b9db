"""Knobs and errors of the trade-off of a flood. Flood spec 8.

Where a pool has an exact solution the depth is compared with it; gauges, the centre of the water and its spread are
compared with a run of half the spacing in double precision.
"""

import numpy as np

from melt.flood.pools import flow_of

KNOBS = [
    ("sub-steps, CFL", "0.15", ["solver.cfl=0.15"]),
    ("sub-steps, CFL", "0.6", ["solver.cfl=0.6"]),
    ("support/r0", "2.0", ["solver.support=2.0"]),
    ("support/r0", "3.2", ["solver.support=3.2"]),
    ("largest support", "3 h0", ["solver.support_limits=[0.25, 3]"]),
    ("largest support", "10 h0", ["solver.support_limits=[0.25, 10]"]),
    ("depth iterations", "0 (paper)", ["solver.iterations=0"]),
    ("depth iterations", "1", ["solver.iterations=1"]),
    ("depth iterations", "2", ["solver.iterations=2"]),
    ("form", "symmetric", ["solver.form=symmetric"]),
    ("form", "balanced", ["solver.form=balanced"]),
    ("Lax-Friedrichs", "0.25", ["solver.alpha=0.25"]),
    ("Lax-Friedrichs", "0.5", ["solver.alpha=0.5"]),
    ("Lax-Friedrichs", "2", ["solver.alpha=2"]),
    ("smoothing", "cubic", ["solver.kernel=cubic"]),
    ("layout", "equal_area", ["fluid.layout=equal_area"]),
    ("layout", "lattice", ["fluid.layout=lattice"]),
    ("layout", "not evened", ["fluid.even=false"]),
    ("terrain", "bilinear", ["terrain.sampler=bilinear"]),
    ("terrain", "bicubic", ["terrain.sampler=bicubic"]),
    ("precision", "mixed", ["solver.precision=mixed"]),
    ("precision", "double", ["solver.precision=double"]),
]


def knobs_of(scene):
    """Return the knobs of a flood: spacings and walls first, then those that all floods have."""
    dx = scene.fluid.spacing
    own = [("spacing", f"{f:g} r0", [f"fluid.spacing={f * dx!r}"]) for f in (2.0, 1.5, 0.75)]
    if scene.boundary.columns:
        own.append(("walls", "hard edge alone", ["boundary.columns=false"]))
    if scene.control is not None:
        own.append(("control force", "off", ["control=none"]))
    else:
        own.append(("control force", "on", ["control.mode=descent"]))
    return own + KNOBS


def reference_of(scene):
    """Return the overrides of the run that others are compared with."""
    return [f"fluid.spacing={0.5 * scene.fluid.spacing!r}", "solver.precision=double", "solver.cfl=0.2"]


def curves(sim):
    """Return the figures of now, all lengths in m; those that begin with "exact" are errors themselves."""
    scene, terrain = sim.scene, sim.initial.terrain
    wet = sim.read("phase") == 0
    V, x = sim.read("rest_volume")[wet].astype(float), sim.read("position")[wet].astype(float)
    middle = (V[:, None] * x[:, :2]).sum(axis=0) / V.sum()
    found = {
        "centre": float(np.hypot(*middle)),
        "spread": float(np.sqrt((V * ((x[:, :2] - middle) ** 2).sum(axis=1)).sum() / V.sum())),
    }
    for pool in scene.fluid.fill:
        if pool.profile is not None and pool.profile.startswith("thacker"):
            exact = flow_of(pool, terrain, scene.gravity, scene.terrain.sampler, "pool", sim.time)(x[:, 0], x[:, 1])[0]
            d = sim.read("depth")[wet].astype(float)
            area = V / np.maximum(d, 1e-9)
            found["exact L1(d)"] = float((area * np.abs(d - exact)).sum() / max((area * exact).sum(), 1e-300))
    for k, name in enumerate(sim.prepared.settings.gauges):
        found[f"gauge {name}"] = float(sim.state.read("sample_surface")[sim.initial.map_nodes + k])
    return found
