"""The dial of melting scenes: weakly compressible liquid, shape matched solids, heat. Melting spec 7.

The reference run has an eighth of the default's compression (2.8 times the sub-steps) in double precision, and eight
thermal sub-steps. The spacing is the scene's own: the error is that of the numerics at it, not of its resolution.
"""

import numpy as np

from melt.dial.vocabulary import Knob, Measure, temperature

MECHANICS = [
    Knob("sub-steps", "0.5x as many", ("fluid.compression=0.04",)),
    Knob("sub-steps", "1.4x as many", ("fluid.compression=0.005", "time.n_sub_max=64")),
    Knob("sub-steps", "2x as many", ("fluid.compression=0.0025", "time.n_sub_max=64")),
    Knob("support h/dx", "2.0", ("solver.support=2.0",)),
    Knob("support h/dx", "3.0", ("solver.support=3.0",)),
    Knob("precision", "single", ("solver.precision=single",)),
    Knob("precision", "double", ("solver.precision=double",)),
    Knob("smoothing", "wendland2", ("solver.kernel=wendland2",)),
    Knob("sub-steps", "1 (legal c_s)", ("time.n_sub=1", "fluid.sound_speed=legal")),
    Knob("smoothing", "mueller", ("solver.kernel=mueller",)),
    Knob("mirror beta", "0", ("solver.mirror=0",)),
    Knob("guard", "off", ("solver.guard=false",)),
    Knob("neighbours", "kdtree", ("solver.neighbours=kdtree",)),
]
SOLIDS = [
    Knob("region width w", "1", ("solver.width=1",)),
    Knob("region width w", "3", ("solver.width=3",)),
    Knob("bodies", "rigid", ("solver.baseline=rigid",)),
    Knob("solid volume", "akinci", ("solver.solid_volume=akinci",)),
    Knob("melt every", "4 steps", ("solver.melt_every=4",)),
    Knob("damping", "0", ("solver.damping=0",)),
    Knob("rotation", "svd", ("solver.rotation=svd",)),
    Knob("refill", "all", ("solver.refill=all",)),
]
HEAT = [
    Knob("heat solver", "onesided", ("heat.solver=onesided",)),
    Knob("heat solver", "explicit", ("heat.solver=explicit",)),
    Knob("heat solver", "pairs_coloured", ("heat.solver=pairs_coloured",)),
    Knob("heat solver", "cg 1e-3", ("heat.solver=cg", "heat.tolerance=1e-3")),
    Knob("heat solver", "cg 1e-8", ("heat.solver=cg", "heat.tolerance=1e-8")),
    Knob("heat sub-steps", "4", ("heat.substeps=4",)),
    Knob("heat solver", "pairs, full sweeps", ("heat.solver=pairs_coloured", "heat.sweep_dt=full")),
    Knob("Laplacian", "brook", ("solver.laplacian=brook",)),
]
MOTION_REFERENCE = ("solver.precision=double", "fluid.compression=0.00125", "time.n_sub_max=128")


def knobs(scene):
    """Return the knobs that make a difference in a scene, one at a time."""
    moving = MECHANICS + (SOLIDS if scene.solid else []) if scene.solver.motion else []
    return moving + (HEAT if scene.heat else [])


def combined(scene):
    """Return both ends: what is cheap together, and what is dear together."""
    heat = ("heat.solver=onesided",) if scene.heat else ()
    finer = ("heat.substeps=2",) if scene.heat else ()
    if not scene.solver.motion:
        return [
            Knob("combined", "cheap", (*heat, "solver.precision=single", "solver.support=2.0")),
            Knob("combined", "dear", ("heat.substeps=4", "solver.precision=double")),
        ]
    cheap = ("fluid.compression=0.04", "solver.precision=single")
    dear = ("fluid.compression=0.0025", "time.n_sub_max=64", "solver.precision=double")
    return [
        Knob("combined", "cheap", cheap),
        Knob("combined", "cheapest", (*cheap, "solver.support=2.0", *heat)),
        Knob("combined", "dear", (*dear, *finer)),
        Knob("combined", "light", ("fluid.compression=0.02", "solver.precision=single")),
    ]


def reference(scene):
    """Return the overrides of the reference run."""
    own = ["heat.substeps=8"] if scene.heat else []
    return [*MOTION_REFERENCE, *own] if scene.solver.motion else ["solver.precision=double", "heat.substeps=16"]


def shared(scene):
    """Return what all runs share: nothing."""
    return []


def shortest(scene):
    """Return the shortest run that tells anything [s]: heat needs time to reach the particles that melt."""
    return 0.5 if scene.heat else 0.0


def reseeded(scene, k):
    """Return [] : nothing is random."""
    return []


def measure(scene):
    """Return the `Measure`: all in their change, but positions in a spacing at least, shares and temperatures in a tenth of the range.

    Compression is a share as it is. Where nothing moves the scatter of the temperature is compared, in a hundredth of its range.
    """
    words = ["height of the centre of mass"] if scene.solver.motion else []
    floors = {"height": 1.0} if scene.solver.motion else {"temperature spread": 0.01}
    if scene.solver.motion and scene.solid:
        floors["solid height"] = 1.0
        words.append("of the solids")
    if scene.solver.motion:
        floors["compression"] = 1.0
        words.append("mean compression")
    if scene.heat:
        floors |= {"melted": 0.1, "temperature": 0.1} if scene.solver.motion else {"melted": 0.1}
        words.append("melted share, mean temperature" if scene.solver.motion else "scatter of the temperature, melted share")
    return Measure("r.m.s. distance from the converged run, the worst of: " + ", ".join(words), floors)


def curves(sim):
    """Return the figures of now: heights in spacings, compression and melted fraction as shares, temperature in its range."""
    values = sim.series()
    phase, x, m = sim.read("phase"), sim.read("position")[:, 2].astype(float), sim.read("mass").astype(float)
    mobile, solid, dx = phase <= 1, phase == 1, sim.scene.spacing
    found = {"height": float((m * x)[mobile].sum() / m[mobile].sum() / dx)}
    if sim.prepared.need.solids:
        found["solid height"] = float((m * x)[solid].sum() / m[solid].sum() / dx) if solid.any() else np.nan
    if sim.scene.solver.motion:
        found["compression"] = values.get("density_error_mean", 0.0)
    if "melted_fraction" in values and sim.prepared.need.melting:
        found["melted"] = values["melted_fraction"]
    if "temperature_mean" in values and not sim.scene.solver.motion:
        T = sim.read("temperature").astype(float)[mobile]
        found["temperature spread"] = float(T.std() / max(np.ptp(sim.initial["temperature"]), 1e-9))
    return found | temperature(sim)
