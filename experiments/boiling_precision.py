"""Boiling paper, effect precision: time saved, and what it costs at the surface and at the bottom.

The paper claims 16-24 % faster with per-particle support radius and iterations, eq (15). Rows: a column of 10 x 20 x 10
particles stirred from the start (a swirl of 0.5 m/s), and `kettle` boiling, each with effect precision off, with its two
parts alone, with both, and the fair rivals: fewer iterations for all, a shorter support for all. Pair visits are counted
from the lists; the errors are the mean compression of the lowest three layers (C bottom), the r.m.s. compression in
the top fifth of the liquid, and the r.m.s. speed; spec V23 bounds apply to the column.
"""

import time

import h5py
import numpy as np

from experiments import Row
from melt.geometry.build import build
from melt.scene import load_scene, scene_from_dict
from melt.simulation import Simulation

ON = {"precision": True}
VARIANTS = {
    "off": {},
    "iterations only": {**ON, "minimum_support": 2.2},
    "3 iterations for all": {"iterations": 3},
    "support only": {**ON, "minimum_iterations": 4},
    "support 1.8 d for all": {"support": 1.8},
    "both": ON,
}


def column(pbf, layers=20):
    """Return the stirred column."""
    d, pbf = 0.02, dict(pbf)
    solver = {"pressure": "pbf", "precision": "single", "support": pbf.pop("support", 2.2), "pbf": pbf}
    return scene_from_dict({
        "time": {"end": 10.0, "dt": 1 / 240, "n_sub": 1},
        "domain": {"upper": [10 * d, 10 * d, 1.5 * layers * d], "spacing": d},
        "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [10 * d, 10 * d, layers * d]}]},
        "solver": solver,
    })


def stirred(scene):
    """Return the initial state with a swirl of up to 0.5 m/s about the middle of the tank."""
    initial = build(scene)
    liquid = initial["phase"] == 0
    x = initial["position"][:, liquid]
    middle = x.mean(axis=1, keepdims=True)
    reach = np.abs(x - middle).max()
    turn = np.stack([-(x - middle)[1], (x - middle)[0], 0 * x[0]]) / reach
    initial["velocity"][:, liquid] = 0.5 * turn * np.sin(np.pi * x[2] / x[2].max())
    return initial


def kettle(pbf):
    """Return the boiling tank with a variant of the solver."""
    pbf = dict(pbf)
    support = pbf.pop("support", 2.2)
    keys = [f"solver.pbf.{k}={str(v).lower() if isinstance(v, bool) else v}" for k, v in pbf.items()]
    return load_scene("kettle", [f"solver.support={support}", *keys])


def visits(sim):
    """Return pair visits of the density solve per liquid particle and sub-step."""
    state = sim.state
    key, count = state.read("iteration_key").astype(np.int64), state.read("neighbour_count")
    return float((key * count).sum() / (sim.read("phase") == 0).sum())


def measure(scene, initial, warm, steps):
    """Return the means over ``steps`` outer steps after ``warm`` ones."""
    sim = Simulation(scene, "cpu", initial=initial)
    for _ in range(warm):
        sim.step()
    d, found, spent, cpu = scene.spacing, [], [], time.process_time()
    for _ in range(steps):
        began = time.perf_counter()
        sim.step()
        spent.append(time.perf_counter() - began)
    cpu = (time.process_time() - cpu) / steps
    for _ in range(max(1, steps // 4)):
        sim.step()
        liquid = sim.read("phase") == 0
        z = sim.read("position")[liquid, 2] - scene.domain.lower[2]
        C = np.maximum(sim.read("constraint")[liquid].astype(float), 0)
        v = sim.read("velocity")[liquid].astype(float)
        top = z > np.quantile(z, 0.8)
        found.append((C[z < 3 * d].mean(), np.sqrt((C[top] ** 2).mean()), np.sqrt((v**2).sum(axis=1).mean()), visits(sim)))
    bottom, surface, speed, pairs = np.mean(found, axis=0)
    return {
        "ms": 1e3 * float(np.median(spent)), "cpu": 1e3 * cpu, "bottom": bottom, "surface": surface, "speed": speed,
        "visits": pairs, "liquid": int(liquid.sum()),
    }


def run(out, quick=False, say=print):
    """Measure all variants in both scenes (``quick``: the column, few steps)."""
    warm, steps = (2, 3) if quick else (120, 120)
    with h5py.File(out, "w") as file:
        for name, make in {"column": column, "kettle": kettle}.items():
            if quick and name == "kettle":
                continue
            for variant, pbf in VARIANTS.items():
                scene = make(pbf, layers=6) if quick else make(pbf)
                initial = stirred(scene) if name == "column" else build(scene)
                found = measure(scene, initial, warm, steps)
                file.create_group(f"{name}/{variant}").attrs.update(found)
                say(f"{name:<8}{variant:<24}" + ", ".join(f"{k} {v:.4g}" for k, v in found.items()))
        file.attrs["quick"] = quick


def report(path):
    """Return a row per variant, with the bounds of V23 for the column."""
    rows = []
    with h5py.File(path) as file:
        for name in file:
            off = dict(file[name]["off"].attrs)
            for variant in VARIANTS:
                a = dict(file[name][variant].attrs)
                saved, fewer = 1 - a["ms"] / off["ms"], 1 - a["visits"] / off["visits"]
                worse = a["surface"] / max(off["surface"], 1e-12) - 1
                bound, ok = "", None
                if name == "column" and not file.attrs["quick"]:
                    if variant == "iterations only":
                        bound = "visits -20..-28 %, time -12 % at least, surface error +20 % at most"
                        ok = bool(0.20 <= fewer <= 0.28 and saved >= 0.12 and worse <= 0.2)
                    if variant == "both":
                        bound, ok = "visits -50 % at least", bool(fewer >= 0.5)
                rows.append(Row(
                    f"{name}, {variant}", "16-24 % faster" if variant == "both" else "",
                    f"{a['ms']:.2f} ms per step ({-saved:+.0%}), pair visits {a['visits']:.0f} per particle ({-fewer:+.0%})", bound, ok,
                    f"{a['liquid']:,} liquid, single precision, 4 iterations at most, 1 sub-step; C bottom {a['bottom']:.2%}, C top "
                    f"{a['surface']:.2%} ({worse:+.0%}), v rms {a['speed']:.3f} m/s, {a['cpu']:.2f} ms CPU",
                ))
    return rows
