"""Knobs and errors of the trade-off of incompressible and viscous liquids. Slime spec 8.

All runs share one outer step, so that curves are compared at the same times whatever the sub-step, which follows the Courant
number. Of a thread it is four times the scene's dt, which would be shorter than most sub-steps. Not of other scenes: the number
of sub-steps is chosen once per outer step, and water that begins to fall is four times as fast at its end.
A nozzle is brought near the floor: a thread reaches it after a third of 0.8 s.
"""

import numpy as np

LONGER = 4  # outer step of a thread in units of the scene's
SPAN = 0.8  # s of a thread; what falls or collapses is over at its own end
KNOBS = [
    ("sub-step", "x 0.5", ["solver.dfsph.courant=0.2"]),
    ("sub-step", "x 2", ["solver.dfsph.courant=0.8"]),
    ("sub-step", "x 4", ["solver.dfsph.courant=1.6"]),
    ("semi-Lagrangian", "x 1", ["solver.dfsph.semi_lagrangian=true", "solver.dfsph.courant=0.4"]),
    ("semi-Lagrangian", "x 2", ["solver.dfsph.semi_lagrangian=true", "solver.dfsph.courant=0.8"]),
    ("semi-Lagrangian", "x 4", ["solver.dfsph.semi_lagrangian=true", "solver.dfsph.courant=1.6"]),
    ("density tolerance", "1e-3", ["solver.dfsph.density_tolerance=1e-3"]),
    ("density tolerance", "1e-5", ["solver.dfsph.density_tolerance=1e-5", "solver.dfsph.max_iterations=1000"]),
    ("divergence tolerance", "1e-2", ["solver.dfsph.divergence_tolerance=1e-2"]),
    ("divergence tolerance", "1e-4", ["solver.dfsph.divergence_tolerance=1e-4", "solver.dfsph.max_iterations=1000"]),
    ("momentum", "off", ["solver.dfsph.accelerate=false"]),
    ("warm start", "0", ["solver.dfsph.warm_start=0"]),
    ("warm start", "0.5", ["solver.dfsph.warm_start=0.5"]),
    ("support h/dx", "2.0", ["solver.support=2.0"]),
    ("support h/dx", "2.4", ["solver.support=2.4"]),
    ("support h/dx", "3.0", ["solver.support=3.0"]),
    ("precision", "single", ["solver.precision=single"]),
    ("precision", "double", ["solver.precision=double"]),
    ("APIC per axis", "1", ["solver.apic.per_axis=1"]),
    ("APIC per axis", "2", ["solver.apic.per_axis=2"]),
    ("APIC per axis", "3", ["solver.apic.per_axis=3"]),
    ("APIC, share of FLIP", "0.9", ["solver.apic.flip=0.9"]),
]
POISSON = [
    ("Poisson tolerance", "1e-2", ["solver.dfsph.poisson_tolerance=1e-2"]),
    ("Poisson tolerance", "1e-6", ["solver.dfsph.poisson_tolerance=1e-6", "solver.dfsph.poisson_iterations=2000"]),
]
VISCOUS = [
    ("viscosity tolerance", "1e-2", ["viscosity.tolerance=1e-2"]),
    ("viscosity tolerance", "1e-6", ["viscosity.tolerance=1e-6"]),
    ("Stokes", "split", ["viscosity.stokes=split"]),
    ("Stokes", "al", ["viscosity.stokes=al"]),
    ("gamma", "1", ["viscosity.gamma=1"]),
    ("gamma", "30", ["viscosity.gamma=30"]),
    ("outer", "1", ["viscosity.outer=1"]),
    ("outer", "4", ["viscosity.outer=4"]),
]
TIGHT = [
    "solver.dfsph.courant=0.2", "solver.precision=double", "solver.dfsph.density_tolerance=1e-5", "solver.dfsph.divergence_tolerance=1e-5",
    "solver.dfsph.poisson_tolerance=1e-6", "solver.dfsph.max_iterations=2000", "solver.dfsph.poisson_iterations=2000",
]


def outer_step(scene):
    """Return the outer step of all runs [s]."""
    return (LONGER if scene.inflow else 1) * scene.time.dt


def base_of(scene):
    """Return the overrides that all runs share."""
    dt = outer_step(scene)
    base = [f"time.dt={dt!r}", "time.n_sub_max=512", f"time.end={steps_of(scene) * dt!r}"]
    for k, nozzle in enumerate(scene.inflow):
        x, y, _ = nozzle.position
        low = scene.domain.lower[2] + 5 * nozzle.radius
        base += [f"inflow.{k}.position=[{x!r}, {y!r}, {low!r}]"]
    return base


def steps_of(scene):
    """Return the outer steps of a run."""
    span = min(scene.time.end, SPAN) if scene.inflow else scene.time.end
    return max(1, int(span / outer_step(scene)))


def knobs_of(scene):
    """Return all knobs that make a difference in a scene."""
    knobs = KNOBS + (POISSON if scene.solver.pressure != "dfsph" else []) + (VISCOUS if scene.viscosity else [])
    if scene.solver.apic is not None:
        knobs = [*knobs, ("APIC", "off", ["solver.apic=none"])]
    if scene.solver.ghosts is None:
        knobs = [*knobs, ("air ghosts", "on", ["solver.ghosts.fill=0.5"])]
    else:  # the Poisson equation has no surface without them
        knobs = [*knobs, ("air ghosts", "off, dfsph", ["solver.ghosts=none", "solver.pressure=dfsph"])]
    base = base_of(scene)
    return [("default", "-", base), *((knob, value, base + overrides) for knob, value, overrides in knobs)]


def reference_of(scene):
    """Return the overrides of the run that others are compared with: half the sub-step, tight solves, double precision."""
    tight = TIGHT + (["viscosity.tolerance=1e-6", "viscosity.outer=4"] if scene.viscosity else [])
    return base_of(scene) + tight


def curves(sim):
    """Return the figures of now, lengths in spacings; "density ..." are errors themselves."""
    dx, liquid = sim.scene.spacing, sim.read("phase") == 0
    x = sim.read("position")[liquid].astype(float)
    found = {"height": float(x[:, 2].mean() / dx)}
    if sim.scene.inflow:
        found["axis"] = float(np.hypot(*x[:, :2].mean(axis=0)) / dx) if sim.scene.domain.dimensions == 3 else float(x[:, 0].mean() / dx)
        found["tip"] = float(np.quantile(x[:, 2], 0.02) / dx)
    else:
        found["front"] = float(np.quantile(x[:, 0], 0.98) / dx)
    found["density error"] = sim.series().get("density_error_mean", np.nan)
    return found
