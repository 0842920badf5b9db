"""``melt bench``: time per stage, per pair and per particle; scaling in n and in threads.

Figures are medians over steps of one run after the first steps (which compile), on an otherwise idle
machine. Ratios within one run are what to read; absolute times belong to the machine that is named.
"""

import math
import statistics
import time

import h5py
import numpy as np

from melt.scene import scene_from_dict
from melt.simulation import Simulation

#: Liquid particles of the scaling series.
SIZES = (10_000, 60_000, 250_000, 1_000_000)
DAM_SPACING, DAM_DT = 0.01, 0.001  # m and s, of `dam_break`


def tank(particles, precision="single", heat=False):
    """Return a scene: a cubic block of water of about ``particles`` collapsing in a walled tank."""
    edge = max(4, round(particles ** (1 / 3)))
    dx = 0.2
    size = edge * dx
    scene = {
        "scene": {"name": f"tank_{edge**3}"},
        "time": {"end": 1.0, "n_sub": 1, "dt": 0.005},
        "domain": {"upper": [1.5 * size, size, size], "spacing": dx, "walls": {"layers": 3}},
        "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [size, size, size]}], "sound_speed": "legal"},
        "solver": {"precision": precision, "kernel": "cubic"},
    }
    if heat:
        scene["heat"] = {"solver": "auto"}
        scene["fluid"]["temperature"] = 40.0
    return scene_from_dict(scene)


def dam_break(particles, support, iterations, precision="single"):
    """Return a scene: a cube of water of about ``particles`` collapsing as a position based fluid, one sub-step a step."""
    dx = DAM_SPACING
    size = max(4, round(particles ** (1 / 3))) * dx
    return scene_from_dict({
        "scene": {"name": "pbf_dam_break"},
        "time": {"end": 1.0, "n_sub": 1, "dt": DAM_DT},
        "domain": {"upper": [1.5 * size, size, size], "spacing": dx, "walls": {"layers": 3}},
        "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [size, size, size]}]},
        "solver": {"precision": precision, "pressure": "pbf", "support": support, "pbf": {"iterations": iterations}},
    })


def flood_release(particles, precision="single"):
    """Return a scene: columns of a cubic metre, 2 m deep at the start, running apart over gentle hills."""
    radius = round((particles / (2 * math.pi)) ** 0.5)
    size = 4.0 * radius
    return scene_from_dict({
        "scene": {"name": "flood_release"},
        "time": {"end": 10.0, "dt": 0.25, "n_sub_max": 100},
        "terrain": {
            "shape": "noise", "lower": [0, 0], "upper": [size, size], "cell": 2.0,
            "parameters": {"amplitude": 2.0, "wavelength": 60.0, "octaves": 3},
        },
        "fluid": {"spacing": 1.0, "fill": [{"centre": [size / 2, size / 2], "radius": radius, "depth": 2.0}]},
        "boundary": {"columns": False},
        "friction": {"manning": 0.03},
        "output": {"maps": False},
        "solver": {"precision": precision},
    })


def time_steps(scene, backend="cpu", warm=3, steps=10, threads=None):
    """Return per-stage medians of one run.

    Returns:
        dict with ``ms`` {stage: ms per sub-step}, ``step_ms`` (wall per sub-step, stages and binder),
        ``particles``, ``liquid``, ``pairs``, ``neighbours``, ``n_sub``, ``bytes``.
    """
    import numba

    before = numba.get_num_threads()
    if threads:
        numba.set_num_threads(threads)
    try:
        sim = Simulation(scene, backend, timed=True)
        for _ in range(warm):
            sim.step()
        samples, walls = {}, []
        for _ in range(steps):
            sim.do.seconds.clear()
            began = time.perf_counter()
            sim.step()
            n_sub = max(1, int(sim.do.notes.get("n_sub", 1)))
            walls.append(1e3 * (time.perf_counter() - began) / n_sub)
            for name, seconds in sim.do.seconds.items():
                samples.setdefault(name, []).append(1e3 * seconds / n_sub)
    finally:
        numba.set_num_threads(before)
    count = sim.state.read("neighbour_count")
    phase = sim.state.read("phase")
    pairs = int(count.sum())
    return {
        "ms": {k: statistics.median(v) for k, v in samples.items()},
        "step_ms": statistics.median(walls),
        "step_ms_best": min(walls),
        "particles": int(sim.do.clock.active),
        "liquid": int((phase == 0).sum()),
        "pairs": pairs,
        "neighbours": pairs / max(1, int((count > 0).sum())),
        "n_sub": n_sub,
        "bytes": sim.state.nbytes,
        "precision": sim.prepared.precision,
        "simulation": sim,
    }


def bare_fluid(sim, steps=10):
    """Return the median ms of a step that calls the fluid's stages and nothing else, written out by hand.

    What `melt.systems.melting.step` costs above it in a fluid-only scene is the price of heat and solids
    being possible.
    """
    do, walls = sim.do, []
    dt = sim.scene.time.dt
    for _ in range(steps):
        began = time.perf_counter()
        do.cell_index()
        do.cell_sort()
        do.reorder()
        do.neighbours_grid()
        do.read("neighbour_count").max()
        do.liquid_volume()
        do.density()
        do.tait_pressure()
        do.boundary_pressure()
        do.fluid_force()
        do.kick(dt=dt)
        do.drift(dt=dt)
        if sim.prepared.need.guard:
            do.guard_offenders()
            do.guard_correction()
            do.swap("position", "position_next")
            do.swap("velocity", "velocity_next")
        do.motion_bounds()
        do.read("motion_bounds")
        walls.append(1e3 * (time.perf_counter() - began))
    return statistics.median(walls)


def solve_ms(result):
    """Return the milliseconds of the stages of the position based solve in a step."""
    return sum(result["ms"].get(name, 0.0) for name in ("pbf_lambda", "pbf_correction", "pbf_move"))


def stage_rows(result):
    """Return rows (stage, ms, share, ns per pair, million particles per second), slowest first."""
    total = sum(result["ms"].values())
    rows = []
    for name, ms in sorted(result["ms"].items(), key=lambda item: -item[1]):
        rows.append(
            (name, ms, ms / total, 1e6 * ms / max(1, result["pairs"]), result["particles"] / max(ms, 1e-9) / 1e3)
        )
    return rows


def run(
    sizes=SIZES, backend="cpu", precision="single", threads=(1, 2), steps=10, out=None, say=print, iterations=None, support=2.0,
    flood=False,
):
    """Measure the scaling series, print tables, and store them in HDF5 if ``out`` is given.

    With ``iterations`` it is a dam break of the position based fluid, with a support of ``support`` spacings; with
    ``flood`` shallow water that runs apart.
    """
    import numba

    threads = [t for t in threads if t <= numba.config.NUMBA_NUM_THREADS]
    results = []
    for n in sizes:
        for t in threads:
            scene = dam_break(n, support, iterations, precision) if iterations else tank(n, precision)
            scene = flood_release(n, precision) if flood else scene
            result = time_steps(scene, backend, steps=steps if n < 500_000 else 4, threads=t)
            result["threads"] = t
            bare = t == threads[-1] and not iterations and not flood
            result["page_over_bare"] = result["step_ms"] / bare_fluid(result["simulation"], 5) if bare else np.nan
            result.pop("simulation")
            results.append(result)
            say(
                f"{result['liquid']:>9,} liquid + {result['particles'] - result['liquid']:,} wall, {t} thread(s), "
                f"{precision}: {result['step_ms']:.2f} ms/sub-step, {1e6 * result['step_ms'] / result['pairs']:.2f} ns/pair, "
                f"{result['neighbours']:.1f} neighbours, {result['bytes'] / result['particles']:.0f} bytes/particle"
                + (f", {iterations} iterations of {solve_ms(result) / iterations:.2f} ms" if iterations else "")
            )
    say("")
    last = results[min(len(results), 2 * len(threads)) - 1]
    say(f"stages at {last['liquid']:,} liquid particles, {last['threads']} thread(s)")
    say(f"{'stage':<22}{'ms':>9}{'share':>8}{'ns/pair':>9}{'Mparticles/s':>14}")
    for name, ms, share, ns, rate in stage_rows(last):
        say(f"{name:<22}{ms:>9.3f}{share:>8.1%}{ns:>9.3f}{rate:>14.1f}")
    if out:
        _store(results, out)
    return results


def _store(results, out):
    with h5py.File(out, "w") as file:
        for k, result in enumerate(results):
            group = file.create_group(f"run_{k:03d}")
            for key, value in result.items():
                if key == "ms":
                    for name, ms in value.items():
                        group.create_group("ms") if "ms" not in group else None
                        group["ms"].attrs[name] = ms
                else:
                    group.attrs[key] = value
