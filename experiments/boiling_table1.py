"""Boiling paper, Table 1: frame rate of the position based fluid against plain SPH.

The paper (i3-4130, about frame 67): 1.96 frames per second with PBF, 1.31 with SPH, +49.6 %; its scene, particle
count and sound speed are lost. Per step SPH is always cheaper, so the claim can only be one per simulated second at
comparable compression: both solvers run the scene `kettle`, SPH with the sound speed at which the bottom of the
resting liquid is compressed as much as PBF compresses it (both measured at rest, mean of the lowest three layers), and
its steps follow from the CFL number cfl = c_s dt/R, which decides the outcome: it is stated in each row. A frame is 1/60 s. v rms
is the agitation of the resting liquid, which SPH holds down with its viscosity of 3 Pa s.
"""

import time

import h5py
import numpy as np

from experiments import Row
from melt.scene import load_scene
from melt.simulation import Simulation

PAPER = {"pbf": 1.96, "sph": 1.31}
FRAME = 1 / 60
CFL = (0.4, 0.6, 0.8)
REST = ["boiling=none"]


def bottom(sim):
    """Return mean max(C, 0) of the lowest three layers, and the r.m.s. speed of the liquid [m/s]."""
    liquid = sim.read("phase") == 0
    z = sim.read("position")[liquid, 2] - sim.scene.domain.lower[2]
    C = sim.read("constraint")[liquid].astype(float)
    v = sim.read("velocity")[liquid].astype(float)
    return float(np.maximum(C[z < 3 * sim.scene.spacing], 0).mean()), float(np.sqrt((v**2).sum(axis=1).mean()))


def rest(name, overrides, seconds):
    """Return bottom compression and agitation of the scene at rest, means over the last half."""
    sim = Simulation(load_scene(name, [*REST, *overrides]), "cpu")
    found = []
    for _ in range(max(4, round(seconds / sim.scene.time.dt))):
        sim.step()
        found.append(bottom(sim))
    return np.mean(found[len(found) // 2 :], axis=0)


def matched(name, goal, seconds, say):
    """Return the sound speed [m/s] at which SPH is compressed by ``goal`` at its bottom, and its figures at rest."""
    scene = load_scene(name)
    depth = max(fill.upper[2] for fill in scene.fluid.fill) - scene.domain.lower[2]
    c = float(np.sqrt(9.81 * depth / goal))
    for _ in range(3):
        C, v = rest(name, sph(c, 0.4), seconds)
        say(f"SPH at rest: c_s {c:.2f} m/s, bottom {C:.2%}, v rms {v:.3f} m/s (wanted {goal:.2%})")
        if abs(C / goal - 1) < 0.05:
            break
        c *= float(np.sqrt(C / goal))
    return c, C, v


def sph(c, cfl):
    """Return the overrides of the baseline."""
    return ["solver.pressure=sph", f"solver.sph.sound_speed={c}", f"solver.sph.cfl={cfl}", "time.n_sub_max=64"]


def boil(name, overrides, warm, frames):
    """Return the figures of ``frames`` frames of the boiling scene after ``warm`` ones."""
    sim = Simulation(load_scene(name, overrides), "cpu", timed=True)
    per_frame = round(FRAME / sim.scene.time.dt)
    for _ in range(max(1, warm * per_frame)):
        sim.step()
    sim.restart_timers()
    steps, wall, cpu = 0, time.perf_counter(), time.process_time()
    for _ in range(frames * per_frame):
        sim.step()
        steps += int(sim.do.notes["n_sub"])
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    values = sim.series()
    return {
        "fps": frames / wall, "cpu_fps": frames / cpu, "steps": steps / frames, "ms": 1e3 * wall / steps,
        "neighbours": values["neighbours_mean"], "liquid": values["liquid_particles"], "bubbles": values["bubbles"],
        "boiled": values["boiled"], "density_max": values["density_error_max"], "quarters": values["quarters_missing"],
    }


def run(out, quick=False, say=print):
    """Match the compression, then time both solvers (``quick``: the small kettle, few frames)."""
    name, seconds, warm, frames = ("kettle_small", 0.1, 1, 2) if quick else ("kettle", 1.0, 60, 30)
    with h5py.File(out, "w") as file:
        C, v = rest(name, [], seconds)
        say(f"PBF at rest: bottom {C:.2%}, v rms {v:.3f} m/s")
        file.create_group("pbf").attrs.update(boil(name, [], warm, frames), compression=C, agitation=v, speed=0.0, cfl=0.0)
        c, C, v = matched(name, C, seconds, say)
        for cfl in CFL:
            group = file.create_group(f"sph {cfl}")
            group.attrs.update(boil(name, sph(c, cfl), warm, frames), compression=C, agitation=v, speed=c, cfl=cfl)
        for key in file:
            a = file[key].attrs
            say(f"{key:<8}{a['fps']:.2f} frames per second, {a['steps']:.1f} steps of {a['ms']:.2f} ms per frame")
        file.attrs.update(scene=name, quick=quick)


def report(path):
    """Return the rows of the table."""
    rows = []
    with h5py.File(path) as file:
        pbf = dict(file["pbf"].attrs)
        for key in file:
            a = dict(file[key].attrs)
            ratio = pbf["fps"] / a["fps"]
            claimed = key == "sph 0.4" and not file.attrs["quick"]
            what = "PBF" if key == "pbf" else f"SPH, c_s {a['speed']:.1f} m/s, CFL {a['cfl']:g}"
            rows.append(Row(
                f"{file.attrs['scene']}, {what}",
                f"{PAPER[key.split()[0]]} frames/s" + ("" if key == "pbf" else "; PBF : SPH 1.496"),
                f"{a['fps']:.2f} frames/s" + ("" if key == "pbf" else f"; PBF : SPH {ratio:.2f}"),
                "1.1-2.5" if claimed else "",
                bool(1.1 <= ratio <= 2.5) if claimed else None,
                f"{a['liquid']:,} liquid, {a['neighbours']:.0f} neighbours, {a['steps']:.1f} steps of {a['ms']:.2f} ms per frame, single "
                f"precision, {a['cpu_fps']:.2f} frames per CPU second; at rest: bottom compression {a['compression']:.2%}, v rms "
                f"{a['agitation']:.3f} m/s; boiling: largest density error {a['density_max']:.1%}, {a['boiled']} particles boiled, "
                f"{a['bubbles']} bubbles at the end, quarters missing {a['quarters']}",
            ))
    return rows
