"""Knobs and errors of the trade-off of a scene that boils. Boiling spec 7.

Boiling is chaotic: single bubbles of two runs part within a second. Compared are what has a meaning in spite of
that: the density error (its own mean, of the bottom and of the surface layer), the height of the surface and the
mean temperature against a reference run, and how much has boiled.
"""

import numpy as np

REFERENCE = ["solver.precision=double", "solver.pbf.iterations=16", "time.n_sub=2"]
KNOBS = [
    ("iterations", "2", ["solver.pbf.iterations=2"]),
    ("iterations", "3", ["solver.pbf.iterations=3"]),
    ("iterations", "8", ["solver.pbf.iterations=8"]),
    ("effect precision", "on", ["solver.pbf.precision=true"]),
    ("effect precision", "iterations only", ["solver.pbf.precision=true", "solver.pbf.minimum_support=2.2"]),
    ("effect precision", "support only", ["solver.pbf.precision=true", "solver.pbf.minimum_iterations=4"]),
    ("effect precision", "a_F 0.25", ["solver.pbf.precision=true", "solver.pbf.height_share=0.25"]),
    ("effect precision", "a_F 0.75", ["solver.pbf.precision=true", "solver.pbf.height_share=0.75"]),
    ("support R/d", "1.8", ["solver.support=1.8"]),
    ("support R/d", "2.0", ["solver.support=2.0"]),
    ("support R/d", "2.5", ["solver.support=2.5", "solver.pbf.eps_rel=1.4"]),
    ("sub-steps", "2", ["time.n_sub=2"]),
    ("sub-steps", "4", ["time.n_sub=4"]),
    ("precision", "mixed", ["solver.precision=mixed"]),
    ("precision", "double", ["solver.precision=double"]),
    ("heat", "particle, eq (10)", ["boiling.heat_model=particle10"]),
    ("heat", "grid, eq (9)", ["boiling.heat_model=grid"]),
    ("boost", "off", ["boiling.boost=off"]),
    ("solver", "SPH of Mueller 2003", ["solver.pressure=sph"]),
]


def curves(sim):
    """Return the figures of now: compression of the lowest and highest layers, surface [dx], temperature [K], boiled share."""
    values, d = sim.series(), sim.scene.spacing
    liquid = sim.read("phase") == 0
    z = sim.read("position")[liquid, 2].astype(float) - sim.scene.domain.lower[2]
    squeezed = np.maximum(sim.read("constraint")[liquid].astype(float), 0)
    low, high = z < 3 * d, z > 0.8 * values["surface_height"]
    start = sim._start["liquids"]
    return {
        "density, bottom": float(squeezed[low].mean()) if low.any() else 0.0,
        "density, top": float(np.sqrt((squeezed[high] ** 2).mean())) if high.any() else 0.0,
        "surface": values["surface_height"] / d,
        "temperature": values.get("temperature_mean", sim.scene.fluid.temperature),
        "boiled": values["boiled"] / max(start, 1),
    }
