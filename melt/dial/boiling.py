"""The dial of position based liquids and of scenes that boil. Boiling spec 7.

Boiling is chaotic: single bubbles of two runs part within a second. Compared is what has a meaning in spite of that: the
compression of the bottom layers, the height of the surface, the mean temperature and how much has boiled, against a run in
double precision with 16 iterations and two sub-steps. The spread over seeds of the bubbles is the noise of this comparison.
"""

import numpy as np

from melt.dial.vocabulary import Knob, Measure, temperature

KNOBS = [
    Knob("iterations", "2", ("solver.pbf.iterations=2",)),
    Knob("iterations", "3", ("solver.pbf.iterations=3",)),
    Knob("iterations", "8", ("solver.pbf.iterations=8",)),
    Knob("support R/d", "1.8", ("solver.support=1.8",)),
    Knob("support R/d", "2.5", ("solver.support=2.5", "solver.pbf.eps_rel=1.4")),
    Knob("sub-steps", "2", ("time.n_sub=2",)),
    Knob("effect precision", "on", ("solver.pbf.precision=true",)),
    Knob("precision", "mixed", ("solver.precision=mixed",)),
    Knob("precision", "double", ("solver.precision=double",)),
    Knob("sub-steps", "4", ("time.n_sub=4",)),
    Knob("effect precision", "iterations only", ("solver.pbf.precision=true", "solver.pbf.minimum_support=2.2")),
    Knob("effect precision", "support only", ("solver.pbf.precision=true", "solver.pbf.minimum_iterations=4")),
    Knob("effect precision", "a_F 0.25", ("solver.pbf.precision=true", "solver.pbf.height_share=0.25")),
    Knob("effect precision", "a_F 0.75", ("solver.pbf.precision=true", "solver.pbf.height_share=0.75")),
    Knob("support R/d", "2.0", ("solver.support=2.0",)),
    Knob("solver", "SPH of Mueller 2003", ("solver.pressure=sph",)),
]
BOILING = [
    Knob("heat", "particle, eq (10)", ("boiling.heat_model=particle10",)),
    Knob("heat", "grid, eq (9)", ("boiling.heat_model=grid",)),
    Knob("boost", "off", ("boiling.boost=off",)),
]


def knobs(scene):
    """Return the knobs that make a difference in a scene, one at a time."""
    found = KNOBS + (BOILING if scene.boiling else [])
    return [knob for knob in found if not scene.solid or _fits_solids(knob)]


def _fits_solids(knob):
    """Return whether a knob is for liquids with solids, too: those have the full precision, heat of their own, and PBF alone."""
    return knob.name not in ("effect precision", "solver", "heat", "boost")


def combined(scene):
    """Return both ends: what is cheap together, and what is dear together."""
    lighter = () if scene.solid else ("solver.pbf.precision=true",)
    return [
        Knob("combined", "cheapest", ("solver.pbf.iterations=2", "solver.support=1.8")),
        Knob("combined", "dear", ("solver.pbf.iterations=8", "time.n_sub=2")),
        Knob("combined", "cheap", ("solver.pbf.iterations=3", *lighter)),
        Knob("combined", "dearest", ("solver.pbf.iterations=12", "time.n_sub=2", "solver.precision=double")),
    ]


def reference(scene):
    """Return the overrides of the reference run."""
    return ["solver.precision=double", "solver.pbf.iterations=16", "time.n_sub=2"]


def shared(scene):
    """Return what all runs share: nothing."""
    return []


def shortest(scene):
    """Return the shortest run that tells anything [s]: no demand."""
    return 0.0


def reseeded(scene, k):
    """Return the overrides of the k-th repetition: other bubbles."""
    return [f"boiling.seed={scene.boiling.seed + k}"] if scene.boiling else []


def measure(scene):
    """Return the `Measure`: all in their change, but the surface in the depth, temperature in a kelvin, boiled in 1 % at least."""
    floors = {"bottom": 1.0, "surface": 1.0, "temperature": 1.0, "boiled": 0.01}
    return Measure(
        "r.m.s. distance from the converged run, the worst of: compression of the bottom layers, height of the surface over the depth, "
        "mean temperature, share that has boiled", floors,
    )


def curves(sim):
    """Return the figures of now: compression of the lowest layers, surface over the depth at the start, temperature, boiled share."""
    values, d = sim.series(), sim.scene.spacing
    liquid = sim.read("phase") == 0
    z = sim.read("position")[liquid, 2].astype(float) - sim.scene.domain.lower[2]
    solved = "constraint" in sim.prepared.fields
    over = sim.read("constraint") if solved else sim.read("density") / sim.scene.fluid.density - 1
    squeezed = np.maximum(over[liquid].astype(float), 0)
    low = z < 3 * d
    depth = float(np.ptp(sim.initial["position"][2, sim.initial["phase"] == 0])) + d
    top = values.get("surface_height", float(np.quantile(z, 0.98)) if z.size else 0.0)
    found = {"bottom": float(squeezed[low].mean()) if low.any() else 0.0, "surface": top / depth}
    if "boiled" in values:
        found["boiled"] = values["boiled"] / max(sim._start["liquids"], 1)
    return found | temperature(sim)
