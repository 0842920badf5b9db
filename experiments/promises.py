"""The price of each promise: precision, order, fastmath, lists, and what each system adds

Every row is one run beside another of the same scene in the same process, that of the scene as it is: ratio of the time of an
outer step, and the headline error of both (`melt tradeoff`: distance from a converged run, or from an exact solution). Order:
the share of a step that goes into sorting by cell (which makes rows ascend) and into listing by id. Fastmath: the same run in
a process whose loops are compiled without its flags. List reuse: heat in a body at rest, with lists made anew every step. Of
moving liquids lists are made in every sub-step; there is no switch, and so no price.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

from experiments import Row
from melt.dial import measure, sweep, systems
from melt.dial.report import percent
from melt.dial.vocabulary import Knob, errors_of, headline
from melt.scene import load_scene
from melt.simulation import Simulation

PRECISION = [Knob("precision", name, (f"solver.precision={name}",)) for name in ("single", "mixed", "double")]
#: Scene -> (outer steps, candidates beside the scene as it is).
SWEEPS = {
    "ice_cube_small": (20, [*PRECISION, Knob("neighbours", "KD-tree", ("solver.neighbours=kdtree",))]),
    "stefan_front_small": (40, [
        *PRECISION,
        *(Knob("heat solver", name, (f"heat.solver={name}",)) for name in ("pairs_coloured", "onesided", "explicit", "cg")),
    ]),
    "kettle_small": (60, [
        *PRECISION, Knob("effect precision", "on", ("solver.pbf.precision=true",)),
    ]),
    "stoker": (15, PRECISION),
    "rough_terrain": (40, [Knob("control force", "off", ("control=none",))]),
    "hydrostatic": (20, [
        *PRECISION, Knob("ghost particles", "off, dfsph", ("solver.ghosts=none", "solver.pressure=dfsph")),
    ]),
}  # fmt: skip
ORDERED = {"ice_cube_small": 20, "kettle_small": 60, "stoker": 15, "hydrostatic": 10}
#: Scene of the run without fastmath: one, as all its stages compile anew.
PLAIN, PLAIN_STEPS = "ice_cube_small", 20
CHILD = """
import json, sys
import melt._compile as policy
policy.FASTMATH = False
from melt.dial import measure
from melt.scene import load_scene
made = measure.sample(load_scene(sys.argv[1]), float(sys.argv[2]))
curves = {name: curve.tolist() for name, curve in made.curves.items()}
print(json.dumps([made.times.tolist(), curves, made.ms_per_step]))
"""


def run(out, quick=False, say=print):
    """Measure all (``quick``: two candidates of one scene, 5 steps)."""
    rows = []
    for name, (steps, knobs) in SWEEPS.items() if not quick else [("stefan_front_small", (5, PRECISION[:2]))]:
        rows += _swept(name, 5 if quick else steps, knobs, say)
    if not quick:
        rows += [row for name, steps in ORDERED.items() for row in _ordered(name, steps)]
        rows += _relisted("stefan_front_small", 40)
        rows += _without_fastmath()
    with h5py.File(out, "w") as file:
        for name, values in zip(("case", "ratio", "error", "default", "note"), zip(*rows)):
            file[name] = list(values)


def _swept(name, steps, knobs, say):
    """Return rows (case, ratio of times, error, error of the default, note) of one scene."""
    default = load_scene(name)
    knobs = [k for k in knobs if load_scene(name, k.overrides) != default]
    points = sweep.run(name, steps=steps, within=float("inf"), knobs=[Knob("default", ""), *knobs], say=say).front.points
    first = points[0]
    own = f"the scene as it is: {default.solver.precision} precision; spread over seeds "
    return [
        (f"{name}: {p.point}", p.ms_per_step / first.ms_per_step, p.error, first.error, p.failure or own + percent(p.spread))
        for p in points[1:]
    ]


def _ordered(name, steps):
    """Return the rows of the share of a step that order costs."""
    sim = Simulation(load_scene(name), "cpu", timed=True)
    sim.step()
    sim.restart_timers()
    for _ in range(steps):
        sim.step()
    ms = {key[3:]: value for key, value in sim.series().items() if key.startswith("ms/")}
    sorting = {stage: ms.get(stage, 0.0) for stage in ("cell_sort", "order_by_id")}
    said = ", ".join(f"{stage} {100 * value / sum(ms.values()):.2g} %" for stage, value in sorting.items() if value)
    without = sum(ms.values()) - sum(sorting.values())
    return [(f"{name}: deterministic order", sum(ms.values()) / without, np.nan, np.nan, f"of the stages' time: {said}")]


def _relisted(name, steps):
    """Return the row of a heat run whose lists are made in every step."""
    spent = []
    for again in (False, True):
        sim = Simulation(load_scene(name), "cpu", timed=True)
        sim.step()
        sim.restart_timers()
        for _ in range(steps):
            if again:
                sim.do.listed = False
            sim.step()
        spent.append((sum(v for k, v in sim.series().items() if k.startswith("ms/")), sim.read("temperature")))
    same = "equal bit by bit" if np.array_equal(spent[0][1], spent[1][1]) else "other"
    return [(f"{name}: lists made in every step", spent[1][0] / spent[0][0], np.nan, np.nan, f"temperatures are {same}")]


def _without_fastmath():
    """Return the row of a run compiled without fastmath, in a process and a cache of its own."""
    scene = load_scene(PLAIN)
    system, window = systems.system_of(scene), PLAIN_STEPS * scene.time.dt
    truth = measure.reference_run(lambda overrides: load_scene(PLAIN, overrides), system.reference(scene), window)[0].truth
    flagged = measure.sample(scene, window)
    root = pathlib.Path(__file__).resolve().parents[1]
    with tempfile.TemporaryDirectory() as folder:
        paths = os.pathsep.join([str(root), os.environ.get("PYTHONPATH", "")])
        environment = {**os.environ, "MELT_CACHE_DIR": folder, "PYTHONPATH": paths}
        words = [sys.executable, "-c", CHILD, PLAIN, repr(window)]
        said = subprocess.run(words, env=environment, capture_output=True, text=True, check=True).stdout
    times, curves, ms = json.loads(said.splitlines()[-1])
    what = systems.measure_of(scene)
    plain = errors_of(np.array(times), {name: np.array(curve) for name, curve in curves.items()}, truth, what)
    default = errors_of(flagged.times, flagged.curves, truth, what)
    heads = 100 * headline(plain), 100 * headline(default)
    return [(f"{PLAIN}: without fastmath", ms / flagged.ms_per_step, *heads, "in a process of its own")]


def report(path):
    """Return one row per promise."""
    rows = []
    with h5py.File(path) as file:
        for k, case in enumerate(file["case"].asstr()[()]):
            ratio, error, default = (float(file[name][k]) for name in ("ratio", "error", "default"))
            found = f"{ratio:.2f}x the time" if np.isfinite(ratio) else "does not run"
            found += f"; error {percent(error)} (default {percent(default)})" if np.isfinite(error) else ""
            rows.append(Row(case, "", found, "", None, file["note"].asstr()[k]))
    return rows
