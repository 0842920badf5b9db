"""``melt tradeoff SCENE``: sweep the knobs of a scene, one point per line, time beside error.

Every point is one run of the scene with one knob changed. Its error is the distance to a reference run
of the same scene (double precision, twice the sub-steps, a quarter of the compression, converged heat),
so knobs are comparable; where an analytic answer exists (`experiments`), that is used instead. Points
that no other point beats in both time and error form the Pareto front.
"""

import time
from typing import NamedTuple

import h5py
import numpy as np

from melt import tradeoff_boiling, tradeoff_flood, tradeoff_slime
from melt.errors import MeltError
from melt.forecast import forecast
from melt.geometry.build import build
from melt.plan import prepare
from melt.scene import load_scene
from melt.simulation import Simulation

#: (knob, value, overrides) of the mechanical part, of solids, and of heat. Melting spec 7.
MECHANICS = [
    ("sub-steps", "2x as many", ["fluid.compression=0.0025"]),
    ("sub-steps", "0.5x as many", ["fluid.compression=0.04"]),
    ("sub-steps", "1 (legal c_s)", ["time.n_sub=1", "fluid.sound_speed=legal"]),
    ("support h/dx", "2.0", ["solver.support=2.0"]),
    ("support h/dx", "3.0", ["solver.support=3.0"]),
    ("smoothing", "wendland2", ["solver.kernel=wendland2"]),
    ("smoothing", "mueller", ["solver.kernel=mueller"]),
    ("precision", "single", ["solver.precision=single"]),
    ("precision", "double", ["solver.precision=double"]),
    ("neighbours", "kdtree", ["solver.neighbours=kdtree"]),
    ("mirror beta", "0", ["solver.mirror=0"]),
    ("guard", "off", ["solver.guard=false"]),
]
SOLIDS = [
    ("region width w", "1", ["solver.width=1"]),
    ("region width w", "3", ["solver.width=3"]),
    ("rotation", "svd", ["solver.rotation=svd"]),
    ("rotation", "iterative", ["solver.rotation=iterative"]),
    ("solid volume", "akinci", ["solver.solid_volume=akinci"]),
    ("solid scale", "1.0", ["solver.solid_scale=1.0"]),
    ("damping", "0", ["solver.damping=0"]),
    ("refill", "all", ["solver.refill=all"]),
    ("melt every", "4 steps", ["solver.melt_every=4"]),
    ("bodies", "rigid", ["solver.baseline=rigid"]),
]
HEAT = [
    ("heat solver", "pairs_coloured", ["heat.solver=pairs_coloured"]),
    ("heat solver", "pairs, full sweeps", ["heat.solver=pairs_coloured", "heat.sweep_dt=full"]),
    ("heat solver", "onesided", ["heat.solver=onesided"]),
    ("heat solver", "explicit", ["heat.solver=explicit"]),
    ("heat solver", "cg 1e-8", ["heat.solver=cg", "heat.tolerance=1e-8"]),
    ("heat solver", "cg 1e-3", ["heat.solver=cg", "heat.tolerance=1e-3"]),
    ("heat sub-steps", "4", ["heat.substeps=4"]),
    ("Laplacian", "brook", ["solver.laplacian=brook"]),
]
REFERENCE = ["solver.precision=double", "fluid.compression=0.0025", "time.n_sub_max=64", "heat.substeps=4"]


class Point(NamedTuple):
    """One run: wall ms per outer step, and its errors against the reference run."""

    knob: str
    value: str
    ms_per_step: float
    n_sub: int
    neighbours: float
    errors: dict
    failure: str = ""


def sample(scene, steps, warm=2):
    """Run ``steps`` outer steps; return (curves by name, ms per outer step, n_sub, neighbours).

    The curves, at every outer step: height of the centre of mass of all and of the solids [dx], melted
    fraction, mean temperature relative to the range at the start, and the density error.
    """
    sim = Simulation(scene, "cpu")
    curves, spent = [], []
    for _ in range(steps):
        began = time.perf_counter()
        sim.step()
        spent.append(time.perf_counter() - began)
        curves.append(_curves(sim))
    stacked = {name: np.array([c[name] for c in curves]) for name in curves[0]}
    values = sim.series()
    # the first steps compile: they are not timed
    return (
        stacked,
        1e3 * float(np.median(spent[warm:])),
        int(values.get("n_sub", 0)),
        values.get("neighbours_mean", 0.0),
    )


def _curves(sim):
    if sim.scene.kind == "flood":
        return tradeoff_flood.curves(sim)
    if sim.prepared.need.boiling:
        return tradeoff_boiling.curves(sim)
    if sim.prepared.need.incompressible:
        return tradeoff_slime.curves(sim)
    values = sim.series()
    phase, x, m = sim.read("phase"), sim.read("position")[:, 2].astype(float), sim.read("mass").astype(float)
    mobile, solid, dx = phase <= 1, phase == 1, sim.scene.spacing
    found = {"height": float((m * x)[mobile].sum() / m[mobile].sum() / dx)}
    if solid.any():
        found["solid height"] = float((m * x)[solid].sum() / m[solid].sum() / dx)
    elif sim.prepared.need.solids:
        found["solid height"] = np.nan
    if sim.scene.solver.motion:
        found["density"] = values.get("density_error_mean", 0.0)
    if "melted_fraction" in values and sim.prepared.need.melting:
        found["melted"] = values["melted_fraction"]
    if "temperature_mean" in values and not sim.scene.solver.motion:
        T = sim.read("temperature").astype(float)[mobile]
        start = sim.initial["temperature"]
        found["temperature spread"] = float(T.std() / max(np.ptp(start), 1e-9))
    elif "temperature_mean" in values:
        start = sim.initial["temperature"]
        found["temperature"] = values["temperature_mean"] / max(np.ptp(start), 1e-9)
    return found


def error_of(curves, truth):
    """Return {name: root mean square distance of a curve from the reference's}; "density ..." and "exact ..." are their own means."""
    errors = {}
    for name, curve in curves.items():
        if name.startswith(("density", "exact")):
            errors[name] = float(curve.mean())
            continue
        both = np.isfinite(curve) & np.isfinite(truth[name])
        errors[name] = float(np.sqrt(np.mean((curve - truth[name])[both] ** 2))) if both.any() else np.nan
    return errors


def pareto(points, error):
    """Return the indices of points that no other point beats in both time and ``error``."""
    best = []
    for i, p in enumerate(points):
        if p.failure or not np.isfinite(p.errors.get(error, np.nan)):
            continue
        beaten = any(
            q.ms_per_step <= p.ms_per_step
            and q.errors[error] <= p.errors[error]
            and (q.ms_per_step < p.ms_per_step or q.errors[error] < p.errors[error])
            for q in points
            if not q.failure and np.isfinite(q.errors.get(error, np.nan))
        )
        if not beaten:
            best.append(i)
    return best


def knobs_of(scene):
    """Return the knobs that make a difference in a scene."""
    knobs = [("default", "-", [])]
    if scene.kind == "flood":
        return knobs + tradeoff_flood.knobs_of(scene)
    if scene.boiling:
        return knobs + tradeoff_boiling.KNOBS
    if scene.incompressible:
        return tradeoff_slime.knobs_of(scene)
    if scene.solver.motion:
        knobs += MECHANICS
        knobs += SOLIDS if scene.solid else []
    if scene.heat:
        knobs += HEAT
    return knobs


def expected(scenes, steps):
    """Return how many runs there are and about how long they take together, in words."""
    seconds = 0.0
    for scene in scenes:
        initial = build(scene)
        seconds += forecast(scene, initial, prepare(scene, initial), steps).seconds
    long = f"{seconds:,.0f} s" if seconds < 120 else f"{seconds / 60:,.0f} min"
    return (
        f"{len(scenes)} runs, about {long} together on 2 free cores; what is not cached compiles first, "
        "one to two minutes for each precision and a few seconds for a new solver"
    )


def run(name, out=None, steps=None, knobs=None, say=print):
    """Sweep a scene; print one line per point; write HDF5 and a plot if ``out`` (a .h5 path) is given.

    Returns:
        (list of `Point`, list of error names).
    """
    scene = load_scene(name)
    steps = steps or (tradeoff_slime.steps_of(scene) if scene.incompressible else min(scene.time.steps, 100))
    reference = [o for o in REFERENCE if (scene.heat or not o.startswith("heat"))]
    if scene.boiling:
        reference = tradeoff_boiling.REFERENCE
    if scene.kind == "flood":
        reference = tradeoff_flood.reference_of(scene)
    if scene.incompressible:
        reference = tradeoff_slime.reference_of(scene)
    knobs = knobs or knobs_of(scene)
    dt = load_scene(name, reference).time.dt
    say(f"{name}: {steps} outer steps of {dt:g} s; reference run: {', '.join(reference)}")
    say(expected([load_scene(name, overrides) for overrides in (reference, *(k[2] for k in knobs))], steps))
    truth, ms, n_sub, _ = sample(load_scene(name, reference), steps)
    errors = [e for e in truth]
    header = "".join(f"{e:>20}" for e in errors)
    say(f"{'knob':<16}{'value':<20}{'ms/step':>9}{'n_sub':>6}{'nbrs':>6}{header}")
    say(f"{'reference':<16}{'':<20}{ms:>9.2f}{n_sub:>6}")
    points = []
    for knob, value, overrides in knobs:
        try:
            curves, ms, n_sub, neighbours = sample(load_scene(name, overrides), steps)
            point = Point(knob, value, ms, n_sub, neighbours, error_of(curves, truth))
            line = "".join(f"{point.errors.get(e, np.nan):>20.3g}" for e in errors)
            say(f"{knob:<16}{value:<20}{ms:>9.2f}{n_sub:>6}{neighbours:>6.0f}{line}")
        except MeltError as error:
            point = Point(knob, value, np.nan, 0, 0.0, {}, str(error))
            say(f"{knob:<16}{value:<20}{'unstable: ' + str(error)[:90]}")
        points.append(point)
    for error in errors:
        names = ", ".join(f"{points[i].knob} {points[i].value}" for i in pareto(points, error))
        say(f"Pareto front ({error}): {names}")
    if out:
        store(points, errors, name, steps, out)
        plot(points, errors, name, str(out).rsplit(".", 1)[0] + ".png")
    return points, errors


def store(points, errors, name, steps, out):
    """Write the points to HDF5."""
    with h5py.File(out, "w") as file:
        file.attrs.update(scene=name, steps=steps)
        file["knob"] = [f"{p.knob} {p.value}" for p in points]
        file["ms_per_step"] = [p.ms_per_step for p in points]
        file["n_sub"] = [p.n_sub for p in points]
        file["failure"] = [p.failure for p in points]
        for error in errors:
            file[f"error/{error}"] = [p.errors.get(error, np.nan) for p in points]
            front = np.zeros(len(points), bool)
            front[pareto(points, error)] = True
            file[f"front/{error}"] = front


def plot(points, errors, name, out):
    """Draw time against each error, with its Pareto front."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(errors), figsize=(6 * len(errors), 5), squeeze=False)
    for ax, error in zip(axes[0], errors):
        good = [p for p in points if not p.failure and np.isfinite(p.errors.get(error, np.nan))]
        floor = min((p.errors[error] for p in good if p.errors[error] > 0), default=1e-6) * 0.5
        for p in good:
            y = max(p.errors[error], floor)
            ax.plot(p.ms_per_step, y, "o", color="#d95f02" if p.knob == "default" else "#1b6ca8")
            ax.annotate(
                f"{p.knob} {p.value}", (p.ms_per_step, y), fontsize=6, xytext=(3, 3), textcoords="offset points"
            )
        front = sorted((points[i].ms_per_step, max(points[i].errors[error], floor)) for i in pareto(points, error))
        ax.plot(*zip(*front), "-", color="#999999", zorder=0) if front else None
        ax.set(
            xscale="log", yscale="log", xlabel="ms per outer step", ylabel=f"error of {error}", title=f"{name}: {error}"
        )
        ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(out, dpi=130)
    plt.close(figure)
