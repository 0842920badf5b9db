"""The dial of floods. Flood spec 8.

Resolution is a knob: the reference run has half the spacing, in double precision with shorter sub-steps, and figures are
integrals that do not depend on where single columns stand.
"""

import numpy as np

from melt.dial.vocabulary import Knob, Measure

MANY = "time.n_sub_max=1000"  # sub-steps at most: what asks for shorter ones must be allowed them
KNOBS = [
    Knob("sub-steps, CFL", "0.6", ("solver.cfl=0.6",)),
    Knob("sub-steps, CFL", "0.15", ("solver.cfl=0.15", MANY)),
    Knob("support/r0", "2.0", ("solver.support=2.0",)),
    Knob("support/r0", "3.2", ("solver.support=3.2",)),
    Knob("depth iterations", "1", ("solver.iterations=1",)),
    Knob("depth iterations", "2", ("solver.iterations=2",)),
    Knob("depth iterations", "0 (paper)", ("solver.iterations=0",)),
    Knob("Lax-Friedrichs", "0.25", ("solver.alpha=0.25",)),
    Knob("Lax-Friedrichs", "0.5", ("solver.alpha=0.5",)),
    Knob("Lax-Friedrichs", "2", ("solver.alpha=2",)),
    Knob("precision", "single", ("solver.precision=single",)),
    Knob("precision", "mixed", ("solver.precision=mixed",)),
    Knob("precision", "double", ("solver.precision=double",)),
    Knob("form", "symmetric", ("solver.form=symmetric",)),
    Knob("form", "balanced", ("solver.form=balanced",)),
    Knob("smoothing", "cubic", ("solver.kernel=cubic",)),
    Knob("terrain", "bilinear", ("terrain.sampler=bilinear",)),
    Knob("terrain", "bicubic", ("terrain.sampler=bicubic",)),
    Knob("largest support", "3 h0", ("solver.support_limits=[0.25, 3]",)),
    Knob("largest support", "10 h0", ("solver.support_limits=[0.25, 10]",)),
    Knob("layout", "equal_area", ("fluid.layout=equal_area",)),
    Knob("layout", "lattice", ("fluid.layout=lattice",)),
    Knob("layout", "not evened", ("fluid.even=false",)),
]


def _spacing(scene, factor):
    return f"fluid.spacing={factor * scene.fluid.spacing!r}"


def knobs(scene):
    """Return the knobs of a flood, one at a time: spacings and walls first, then those that all floods have."""
    own = [Knob("spacing", f"{factor:g} r0", (_spacing(scene, factor), MANY)) for factor in (2.0, 1.5, 0.75)]
    if scene.boundary.columns:
        own.append(Knob("walls", "hard edge alone", ("boundary.columns=false",)))
    control = ("off", ("control=none",)) if scene.control is not None else ("on", ("control.mode=descent",))
    return [*own, Knob("control force", *control), *KNOBS]


def combined(scene):
    """Return both ends: what is cheap together, and what is dear together."""
    single = "solver.precision=single"
    return [
        Knob("combined", "cheap", (_spacing(scene, 1.5), "solver.cfl=0.6", single)),
        Knob("combined", "cheapest", (_spacing(scene, 2.0), "solver.cfl=0.6", single, "solver.support=2.0")),
        Knob("combined", "dear", (_spacing(scene, 0.75), "solver.cfl=0.2", MANY)),
    ]


def reference(scene):
    """Return the overrides of the reference run."""
    return [_spacing(scene, 0.5), "solver.precision=double", "solver.cfl=0.2", MANY]


def shared(scene):
    """Return what all runs share: nothing."""
    return []


def shortest(scene):
    """Return the shortest run that tells anything [s]: no demand."""
    return 0.0


def reseeded(scene, k):
    """Return the overrides of the k-th repetition: columns that stand elsewhere."""
    return [f"fluid.seed={scene.fluid.seed + k}"] if scene.fluid.fill else []


def measure(scene):
    """Return the `Measure`: places in the larger of their change and a 200th of the terrain's diagonal."""
    floors = {"centre x": 1.0, "centre y": 1.0, "spread": 1.0, "motion": 0.01}
    gauges = {f"gauge {gauge.name}": 0.02 for gauge in scene.gauge}
    words = "r.m.s. distance from the run of half the spacing, the worst of: centre of the water, its spread, kinetic energy"
    return Measure(words + (", surface at gauges" if gauges else ""), floors | gauges)


def curves(sim):
    """Return the figures of now: centre and spread in 200ths of the diagonal, root of the kinetic energy per mass over the celerity.

    Gauges are in reference depths of the scene.
    """
    scene, unit = sim.scene, float(np.hypot(*np.ptp(sim.initial.terrain.bounds, axis=0))) / 200
    wet = sim.read("phase") == 0  # none before the first inflow
    V, x = sim.read("rest_volume")[wet].astype(float), sim.read("position")[wet].astype(float)
    v = sim.read("velocity")[wet].astype(float)
    total = max(V.sum(), 1e-300)
    middle = (V[:, None] * x[:, :2]).sum(axis=0) / total
    celerity = np.sqrt(scene.gravity * scene.fluid.reference_depth)
    found = {
        "centre x": middle[0] / unit, "centre y": middle[1] / unit,
        "spread": np.sqrt((V * ((x[:, :2] - middle) ** 2).sum(axis=1)).sum() / total) / unit,
        "motion": np.sqrt((V * (v[:, :2] ** 2).sum(axis=1)).sum() / total) / celerity,
    }
    for k, name in enumerate(sim.prepared.settings.gauges):
        surface = float(sim.state.read("sample_surface")[sim.initial.map_nodes + k])
        found[f"gauge {name}"] = surface / scene.fluid.reference_depth
    return {name: float(value) for name, value in found.items()}
