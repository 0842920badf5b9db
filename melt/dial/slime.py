"""The dial of incompressible and viscous liquids. Slime spec 8.

The reference run has half the sub-step and tight solves in double precision, at the scene's own spacing. A nozzle is brought
near the floor in all runs of a study, or its thread would be in the air for most of it.
"""

import numpy as np

from melt.dial.vocabulary import Knob, Measure, temperature

MANY = "time.n_sub_max=512"  # sub-steps at most: what asks for shorter ones must be allowed them
KNOBS = [
    Knob("sub-step", "x 2", ("solver.dfsph.courant=0.8",)),
    Knob("sub-step", "x 0.5", ("solver.dfsph.courant=0.2", MANY)),
    Knob("density tolerance", "1e-3", ("solver.dfsph.density_tolerance=1e-3",)),
    Knob("support h/dx", "2.0", ("solver.support=2.0",)),
    Knob("support h/dx", "3.0", ("solver.support=3.0",)),
    Knob("precision", "single", ("solver.precision=single",)),
    Knob("precision", "double", ("solver.precision=double",)),
    Knob("divergence tolerance", "1e-2", ("solver.dfsph.divergence_tolerance=1e-2",)),
    Knob("sub-step", "x 4", ("solver.dfsph.courant=1.6",)),
    Knob("semi-Lagrangian", "x 2", ("solver.dfsph.semi_lagrangian=true", "solver.dfsph.courant=0.8")),
    Knob("semi-Lagrangian", "x 1", ("solver.dfsph.semi_lagrangian=true", "solver.dfsph.courant=0.4")),
    Knob("semi-Lagrangian", "x 4", ("solver.dfsph.semi_lagrangian=true", "solver.dfsph.courant=1.6")),
    Knob("density tolerance", "1e-5", ("solver.dfsph.density_tolerance=1e-5", "solver.dfsph.max_iterations=1000")),
    Knob("divergence tolerance", "1e-4", ("solver.dfsph.divergence_tolerance=1e-4", "solver.dfsph.max_iterations=1000")),
    Knob("momentum", "off", ("solver.dfsph.accelerate=false",)),
    Knob("warm start", "0.5", ("solver.dfsph.warm_start=0.5",)),
    Knob("warm start", "0", ("solver.dfsph.warm_start=0",)),
    Knob("support h/dx", "2.4", ("solver.support=2.4",)),
]
APIC = [
    Knob("APIC per axis", "1", ("solver.apic.per_axis=1",)),
    Knob("APIC per axis", "2", ("solver.apic.per_axis=2",)),
    Knob("APIC per axis", "3", ("solver.apic.per_axis=3",)),
    Knob("APIC, share of FLIP", "0.9", ("solver.apic.flip=0.9",)),
]
POISSON = [
    Knob("Poisson tolerance", "1e-2", ("solver.dfsph.poisson_tolerance=1e-2",)),
    Knob("Poisson tolerance", "1e-6", ("solver.dfsph.poisson_tolerance=1e-6", "solver.dfsph.poisson_iterations=2000")),
]
VISCOUS = [
    Knob("viscosity tolerance", "1e-2", ("viscosity.tolerance=1e-2",)),
    Knob("viscosity tolerance", "1e-6", ("viscosity.tolerance=1e-6",)),
    Knob("Stokes", "split", ("viscosity.stokes=split",)),
    Knob("Stokes", "al", ("viscosity.stokes=al",)),
    Knob("gamma", "1", ("viscosity.gamma=1",)),
    Knob("gamma", "30", ("viscosity.gamma=30",)),
    Knob("outer", "1", ("viscosity.outer=1",)),
    Knob("outer", "4", ("viscosity.outer=4",)),
]
TIGHT = [
    "solver.precision=double", "solver.dfsph.density_tolerance=1e-5", "solver.dfsph.divergence_tolerance=1e-5",
    "solver.dfsph.poisson_tolerance=1e-6", "solver.dfsph.max_iterations=2000", "solver.dfsph.poisson_iterations=2000", MANY,
]
LOOSE = ("solver.dfsph.density_tolerance=1e-3", "solver.dfsph.divergence_tolerance=1e-2")


def _outer_step(scene, factor):
    """Return the overrides of another outer step: of threads and plates it is shorter than most sub-steps need to be."""
    return f"time.dt={factor * scene.time.dt!r}"


def knobs(scene):
    """Return the knobs that make a difference in a scene, one at a time."""
    found = [Knob("outer step", f"x {f:g}", (_outer_step(scene, f), MANY)) for f in (2, 0.5, 4)]
    if scene.scene.exact is not None:  # an exact solution knows every spacing
        found.append(Knob("spacing", "x 0.5", (f"domain.spacing={0.5 * scene.spacing!r}",)))
    found += (VISCOUS[:3] if scene.viscosity else []) + KNOBS
    found += (POISSON if scene.solver.pressure != "dfsph" else []) + (VISCOUS[3:] if scene.viscosity else [])
    # a full box has no surface, particles that are shifted have none either; bodies go with DFSPH alone
    if scene.fluid.enclosed or scene.solver.dfsph.shift > 0 or scene.solid:
        return [knob for knob in found if knob.name != "semi-Lagrangian"]
    if scene.heat is None:  # heat stays with particles of constant mass
        found += APIC
    if scene.solver.apic is not None and scene.elastic is None:
        found.append(Knob("APIC", "off", ("solver.apic=none",)))
    if scene.solver.ghosts is None:
        found.append(Knob("air ghosts", "on", ("solver.ghosts.fill=0.5",)))
    else:  # the Poisson equation has no surface without them
        found.append(Knob("air ghosts", "off, dfsph", ("solver.ghosts=none", "solver.pressure=dfsph")))
    return found


def combined(scene):
    """Return both ends: what is cheap together, and what is dear together."""
    loose = (*LOOSE, "solver.precision=single") + (("viscosity.tolerance=1e-2",) if scene.viscosity else ())
    loose += ("solver.dfsph.poisson_tolerance=1e-2",) if scene.solver.pressure != "dfsph" else ()
    tight = ("solver.dfsph.density_tolerance=1e-5", "solver.dfsph.divergence_tolerance=1e-4", "solver.dfsph.max_iterations=1000")
    tight += ("viscosity.tolerance=1e-6",) if scene.viscosity else ()
    return [
        Knob("combined", "cheap", loose),
        Knob("combined", "cheapest", (*loose, _outer_step(scene, 2), MANY, "solver.dfsph.courant=0.8", "solver.support=2.0")),
        Knob("combined", "dear", (*tight, "solver.precision=double", _outer_step(scene, 0.5), "solver.dfsph.courant=0.2", MANY)),
    ]


def reference(scene):
    """Return the overrides of the reference run."""
    viscous = ["viscosity.tolerance=1e-6", "viscosity.outer=4"] if scene.viscosity else []
    return [*TIGHT, *viscous, _outer_step(scene, 0.5), "solver.dfsph.courant=0.2"]


def shared(scene):
    """Return what all runs share: nozzles near the floor."""
    found = []
    for k, nozzle in enumerate(scene.inflow):
        x, y, _ = nozzle.position
        low = scene.domain.lower[2] + 5 * nozzle.radius
        found.append(f"inflow.{k}.position=[{x!r}, {y!r}, {low!r}]")
    return found


def shortest(scene):
    """Return the shortest run that tells anything [s]: a thread must reach the plate, 5 radii below, and pile up on it."""
    return max((8 * nozzle.radius / nozzle.speed for nozzle in scene.inflow), default=0.0)


def reseeded(scene, k):
    """Return the overrides of the k-th repetition: of all that is random in it."""
    s = scene.solver
    found = [f"solver.apic.seed={s.apic.seed + k}"] if s.apic else []
    found += [f"solver.ghosts.seed={s.ghosts.seed + k}"] if s.ghosts else []
    return found + ([f"fluid.seed={scene.fluid.seed + k}"] if scene.fluid.jitter > 0 else [])


def measure(scene):
    """Return the `Measure`: positions in the larger of their change and a spacing."""
    floors = {"height": 1.0, "compression": 1.0} | ({"axis": 1.0, "tip": 1.0} if scene.inflow else {"front": 1.0})
    words = ["height of the centre of mass", "axis and tip of the thread" if scene.inflow else "front", "mean compression"]
    if scene.heat:
        floors["temperature"] = 0.1
        words.append("mean temperature")
    return Measure("r.m.s. distance from the converged run, the worst of: " + ", ".join(words), floors)


def curves(sim):
    """Return the figures of now, lengths in spacings, compression as a share."""
    dx, liquid = sim.scene.spacing, sim.read("phase") == 0
    x = sim.read("position")[liquid].astype(float)
    found = {"height": float(x[:, 2].mean() / dx)}
    if sim.scene.inflow:
        found["axis"] = float(np.hypot(*x[:, :2].mean(axis=0)) / dx) if sim.scene.domain.dimensions == 3 else float(x[:, 0].mean() / dx)
        found["tip"] = float(np.quantile(x[:, 2], 0.02) / dx)
    else:
        found["front"] = float(np.quantile(x[:, 0], 0.98) / dx)
    found["compression"] = sim.series().get("density_error_mean", np.nan)
    return found | temperature(sim)
