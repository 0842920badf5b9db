"""Flood paper, Table 3: frame rate before and after rendering, at 12,000 and 60,000 columns

The paper's frames are steps of 0.02 s on its GPU, 64-75 a second without and 28-35 with rendering; its "ft/s" are
frames per second, and its scenes of 12,000 also hold other objects, so that 60,000 run no slower. Ours are sub-steps of
`melt bench --flood` (water 2 m deep running apart over gentle hills), single precision, all CPU threads, and pictures of
960 x 540 pixels by the screen-space renderer. Medians, on a machine where nothing else runs. The spec's targets on two cores:
100 steps a second at 60,000 columns, 40 ms a picture.
"""

import statistics
import time

import h5py
import numpy as np

from experiments import Row

SIZES = (12_000, 60_000)
PIXELS = (960, 540)
PAPER = {12_000: "64-70 before, 28-34 after rendering", 60_000: "75 before, 35 after rendering"}
STEPS_TARGET, PICTURE_TARGET = 100.0, 40.0  # steps/s and ms at 60,000


def run(out, quick=False, say=print):
    """Time steps and pictures; write medians to ``out``."""
    from melt.bench import flood_release

    with h5py.File(out, "w") as file:
        for n in (2_000,) if quick else SIZES:
            found = _measure(flood_release(n), 3 if quick else 12)
            group = file.create_group(str(n))
            for name, value in found.items():
                group.attrs[name] = value
            say(f"{n}: " + ", ".join(f"{k} {v:.4g}" for k, v in found.items()))


def _measure(scene, rounds):
    """Return medians [ms] of a sub-step and of a picture, and what they were taken with."""
    from melt.output import camera as cameras
    from melt.output.screen import ScreenRenderer
    from melt.simulation import Simulation

    sim = Simulation(scene, "cpu")
    low, high = sim.initial.terrain.bounds
    camera = cameras.fit((*low, 0.0), (*high, 0.05 * (high - low).max()), "iso", *PIXELS)
    renderer = ScreenRenderer(camera, "cpu", below=True)
    renderer.set_terrain(sim.initial.terrain)
    steps, pictures, n_sub = [], [], 0
    for _ in range(rounds + 3):
        began = time.perf_counter()
        sim.step()
        n_sub = int(sim.do.notes["n_sub"])
        steps.append(1e3 * (time.perf_counter() - began) / n_sub)
        position = sim.state.read("position")
        radius = 1.5 * sim.state.read("support_radius") / scene.solver.support
        began = time.perf_counter()
        renderer.draw(position, radius, terrain=sim.initial.terrain)
        pictures.append(1e3 * (time.perf_counter() - began))
    count = sim.state.read("neighbour_count")
    return {
        "columns": int(sim.do.clock.active or count.size), "neighbours": float(count.mean()), "n_sub": n_sub,
        "step_ms": statistics.median(steps[3:]), "picture_ms": statistics.median(pictures[3:]),
        "depth": float(np.median(sim.state.read("depth"))),
    }


def report(path):
    """Return the rows."""
    rows = []
    with h5py.File(path, "r") as file:
        for name in sorted(file, key=int):
            a = dict(file[name].attrs)
            n = int(name)
            before, after = 1e3 / a["step_ms"], 1e3 / (a["step_ms"] + a["picture_ms"])
            large, case = n == 60_000, f"{a['columns']:,.0f} columns, "
            note = f"{a['step_ms']:.2f} ms per sub-step, {a['neighbours']:.0f} listed neighbours, {a['n_sub']:.0f} sub-steps in 0.25 s"
            bound, ok = (f">= {STEPS_TARGET:g}", before >= STEPS_TARGET) if large else ("", None)
            rows.append(Row(case + "frames/s before rendering", PAPER.get(n, ""), f"{before:.1f}", bound, ok, note))
            rows.append(Row(case + "frames/s after rendering", "", f"{after:.1f}", "", None, "one picture each sub-step"))
            bound, ok = (f"<= {PICTURE_TARGET:g} ms", a["picture_ms"] <= PICTURE_TARGET) if large else ("", None)
            rows.append(Row(case + f"picture of {PIXELS[0]} x {PIXELS[1]}", "", f"{a['picture_ms']:.1f} ms", bound, ok))
    return rows
