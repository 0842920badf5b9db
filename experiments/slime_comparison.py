"""A sheet of maltose syrup folds on a plate: the full method, its parts left out, and WCSPH (slime spec, scene A)

The scene is `honey_coil_small` at 0.2 m/s and a spacing of 1.5 mm: 150 Pa s, thread 12 mm wide, nozzle 120 mm above the
plate, 1.3 s. A method's largest stable step is the first of 50, 32, 16, 8, 4 and 2 ms that holds, without sub-steps and
without retries: stable means that every solve converges, no value is lost and no speed exceeds a hundred times the
nozzle's in 0.8 s, in which the thread reaches the plate. WCSPH (`experiments/_wcsph_plane.py`: Tait, explicit viscosity
by the same pair force, NumPy) starts from the thread of the full method at 0.4 s, and its step is halved and bisected. Its wall
time is that of NumPy: compare numbers of steps. Folds are reversals of the place where the thread's axis lands by
half a thread's width or more; area is that of the particles after closing gaps under 1.8 spacings, per particle that
has entered. Pressure noise: a tank 20 spacings deep after 1 s, deviation from rho g depth of particles within three spacings of
the surface, over rho g spacing.
"""

import math
import time
import tomllib

import h5py
import numpy as np

from experiments._slime_comparison_rows import bounds, method, noise
from experiments._slime_measures import Landing, area, compression, entered, folds
from experiments._wcsph_plane import Plane, largest_step
from melt.errors import MeltError
from melt.physics.phases import LIQUID
from melt.scene import scene_from_dict
from melt.scene.load import find_scene
from melt.simulation import Simulation

SPEED, WIDTH, MU, SPACING, END, DT = 0.2, 0.012, 150.0, 0.0015, 1.3, 0.002
LONGER = (0.004, 0.008, 0.016, 0.032, 0.05)
TRIAL = 0.8  # [s], in which a step must prove stable
MIDDLE = 0.4  # [s], when the thread hangs and has not reached the plate
METHODS = {
    "full: APIC, ghosts, ISPH + DFSPH, coupled viscosity": {},
    "without APIC": {"solver.apic": None},
    "without ghosts": {"solver.ghosts": None},
    "without ISPH (pressure = dfsph)": {"solver.pressure": "dfsph"},
    "viscosity and pressure split": {"viscosity.stokes": "split"},
    "DFSPH with split viscosity, nodes only": {
        "solver.apic": None, "solver.ghosts": None, "solver.pressure": "dfsph", "viscosity.stokes": "split",
    },
    "full, semi-Lagrangian, 4 dt": {"solver.dfsph.semi_lagrangian": True, "time.dt": 4 * DT},
}
TANKS = {
    "hybrid with ghosts": {},
    "hybrid without ghosts": {"solver.ghosts": None},
    "DFSPH without ghosts": {"solver.pressure": "dfsph", "solver.ghosts": None},
}


def scene_of(name, changes):
    """Return a shipped scene with ``changes`` {"a.b": value}; None takes a section out."""
    facts = tomllib.loads(find_scene(name).read_text())
    for key, value in changes.items():
        *path, last = key.split(".")
        at = facts
        for part in path:
            at = at[int(part)] if isinstance(at, list) else at.setdefault(part, {})
        if value is None:
            at.pop(last, None)
        else:
            at[last] = value
    return scene_from_dict(facts)


def drip(changes, end=END):
    """Return the scene of the drip."""
    base = {
        "domain.spacing": SPACING, "inflow.0.speed": SPEED, "inflow.0.layers": math.ceil(end * SPEED / SPACING) + 4,
        "time.end": end, "time.dt": DT, "viscosity.mu": MU,
    }
    return scene_of("honey_coil_small", {**base, **changes})


def in_plane(sim, name):
    """Return the two components in the plane of the liquid's particles, by id."""
    return sim.read(name)[sim.read("phase") == LIQUID][:, [0, 2]]


def follow(advance, look, scene, end, every=0.01):
    """Advance to ``end`` [s] and return the measures of a drip; ``look()`` returns (count, number, x, v, ratio): how many have
    entered; which of them, where, how fast, at what density the particles are."""
    width = len(np.arange(-WIDTH / 2, WIDTH / 2 + 1e-9, scene.spacing))
    landing = Landing(width, SPEED, scene.inflow[0].position[2])
    wall, last, mean, most, areas, failed = time.perf_counter(), -math.inf, [], [], [], ""
    t, spent, middle = 0.0, 0.0, None
    while t < end - 1e-9 and not failed:
        try:
            t = advance()
        except MeltError as error:
            failed = str(error)[:120]
        if failed or t - last < every - 1e-9:
            continue
        spent += time.perf_counter() - wall  # measuring is not the method's time
        last, (count, number, x, v, ratio) = t, look()
        if middle is None and t > MIDDLE:
            middle = x, v
        first = number < count  # later ones are nodes that the method added
        landing.look(t, number[first], x[first], v[first])
        found = compression(ratio) if len(ratio) else (0.0, 0.0)
        mean.append(found[0])
        most.append(found[1])
        if count > 30 * width:
            areas.append(area(x, scene.spacing) / (count * scene.spacing**2))
        wall = time.perf_counter()
    _, _, x, v, _ = look()
    times, lateral = landing.line()
    turns, rate = folds(times, lateral, WIDTH / 2)
    return {
        "failed": failed, "reached": t, "wall": spent / max(t, 1e-9), "mean": float(np.mean(mean)), "most": float(np.max(most)),
        "area": areas[-1] if areas else np.nan, "area_first": areas[0] if areas else np.nan,
        "folds": turns, "rate": rate, "particles": len(x), "height": resting_height(x, v),
        "spread": float(np.ptp(x[:, 0])), "times": times, "lateral": lateral, "position": x, "velocity": v,
        "middle": np.stack(middle or (x, v)),
    }


def resting_height(x, v):
    """Return the height [m] below which what has landed lies."""
    rest = np.sqrt((v**2).sum(axis=1)) < SPEED / 3
    return float(np.percentile(x[rest, 1], 98)) if rest.any() else 0.0


def melted(changes, end=END):
    """Return the measures of a run of melt."""
    scene = drip(changes, end)
    sim = Simulation(scene, "cpu")
    counts = {"iterations": 0.0, "retries": 0.0, "steps": 0.0}

    def advance():
        sim.step()
        for key, value in sim.do.notes.items():
            counts["iterations"] += value if key.endswith("_iterations") else 0
            counts["retries"] += value if key == "retries" else 0
        counts["steps"] += sim.do.notes.get("n_sub", 1)
        sim.do.notes.clear()
        return sim.time

    def look():
        ratio = sim.read("density_ratio")[sim.read("phase") == LIQUID]
        return *entered(sim), in_plane(sim, "position"), in_plane(sim, "velocity"), ratio

    return {**follow(advance, look, scene, end), **counts, "dt": scene.time.dt}


def bearable(changes):
    """Return the largest of the steps [s] with which the thread reaches the plate without a failure; the longest are tried first."""
    why = ""
    for dt in (*LONGER[::-1], DT):
        rule = {"time.dt": dt, "time.n_sub": 1, "solver.dfsph.retries": 0, "solver.dfsph.on_fail": "raise"}
        sim = Simulation(drip({**changes, **rule}, TRIAL), "cpu")
        try:
            while sim.time < TRIAL - 1e-9:
                sim.step()
                if not sim.do.clock.max_speed < 100 * SPEED:
                    raise MeltError(f"speed {sim.do.clock.max_speed:.3g} m/s")
        except MeltError as error:
            why = f"{1e3 * dt:g} ms: {error}"[:160]
            continue
        return {"largest": dt, "why": why}
    return {"largest": 0.0, "why": why}


def thread(mu, start=None):
    """Return a WCSPH drip of viscosity ``mu``; ``start``: (x, v) of a thread that hangs already."""
    run = Plane(drip({}), mu=mu)
    if start is not None:
        run.x, run.v = (a.copy() for a in start)
        run.layers = run.nozzle.layers  # nothing enters
    return run


def weak(mu, dt, end=END):
    """Return the measures of a WCSPH run."""
    scene, run = drip({}), thread(mu)

    def advance():
        with np.errstate(all="ignore"):
            run.step(dt)
        if not run.speed < 100 * SPEED:
            raise MeltError(f"diverged: speed {run.speed:.3g} m/s at t = {run.time:.4g} s")
        return run.time

    def look():
        n = min(len(run.x), len(run.density))
        return n, np.arange(n), run.x[:n], run.v[:n], run.density[:n] / run.rest

    found = follow(advance, look, scene, end)
    return {**found, "iterations": 0.0, "retries": 0.0, "steps": float(run.steps), "dt": dt}


def tank(changes, weakly=False):
    """Return (noise near the surface, std of pressure where the density ratio is < 0.9), over rho g spacing, and how many are there."""
    scene = scene_of("hydrostatic", {"domain.spacing": 0.05, **changes})
    d, rest = scene.spacing, scene.fluid.density
    if weakly:
        run = Plane(scene, mu=0.0)
        while run.time < 1.0:
            run.step(0.2 * run.limits()[0])
        z, p, ratio = run.x[:, 1], run.pressure, run.density / rest
    else:
        sim = Simulation(scene, "cpu")
        try:
            while sim.time < 1.0 - 1e-9:
                sim.step()
        except MeltError:
            return math.nan, math.nan, 0
        liquid = sim.read("phase") == LIQUID
        z, p, ratio = sim.read("position")[liquid, 2], sim.read("pressure")[liquid], sim.read("density_ratio")[liquid]
    unit = rest * 9.81 * d
    top = np.percentile(z, 97) + d / 2
    near, few = z > top - 3 * d, ratio < 0.9
    return float(np.std((p - rest * 9.81 * (top - z))[near]) / unit), float(np.std(p[few]) / unit) if few.any() else 0.0, int(few.sum())


def run(out, quick=False, say=print):
    """Run all methods (``quick``: two of them for 0.1 s, no search for steps)."""
    end = 0.1 if quick else END
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for name, changes in list(METHODS.items())[: 2 if quick else None]:
            found = melted(changes, end)
            keep(file, f"drip/{name}", found)
            if not quick:
                keep(file, f"step/{name}", bearable(changes))
            say(f"{name}: {found['wall']:.1f} s per s, folds {found['folds']}, area {found['area']:.4f} {found['failed']}")
        start = file[f"drip/{next(iter(METHODS))}/middle"][()]
        stable(file, start, quick)
        say(f"WCSPH: {dict(file['wcsph'].attrs)}")
        for share in (10, 100)[: 0 if quick else 2]:
            # thin threads and close pairs allow less than the thread at which the limit was measured: 0.7 of it diverged at mu/10
            dt = 0.35 * min(file["wcsph"].attrs["largest"] * share, 0.25 * thread(MU).h / thread(MU).c0)
            found = weak(MU / share, dt, 1.0)
            keep(file, f"drip/WCSPH, mu over {share}", found)
            say(f"WCSPH mu/{share}: {found['wall']:.1f} s per s, folds {found['folds']} {found['failed']}")
        for name, changes in {**TANKS, "WCSPH": None}.items():
            if not quick:
                file[f"tank/{name}"] = tank(changes or {}, changes is None)
                say(f"tank, {name}: {file[f'tank/{name}'][()]}")


def stable(file, start, quick):
    """Find the largest stable step of WCSPH at the full viscosity, and see it fail at the step of the others."""
    low, high = (math.nan, DT) if quick else largest_step(lambda: thread(MU, start), 0.01, 100 * SPEED, 6.4e-5)
    group, trial, speeds = file.create_group("wcsph"), thread(MU, start), []
    with np.errstate(all="ignore"):
        while len(speeds) < 50 and (not speeds or speeds[-1] < 100 * SPEED):
            trial.step(DT)
            speeds.append(trial.speed)
    sound, viscous = trial.limits()
    wall = time.perf_counter()
    trial = thread(MU, start)
    for _ in range(200):
        trial.step(1e-6)
    group.attrs.update(
        largest=low, unstable=high, at_dt=len(speeds), speed=speeds[-1], sound=sound, viscous=viscous,
        ms=5 * (time.perf_counter() - wall), particles=len(trial.x),
    )


def keep(file, name, found):
    """Write a dict of measures as a group."""
    group = file.create_group(name)
    for key, value in found.items():
        if isinstance(value, np.ndarray):
            group[key] = value
        else:
            group.attrs[key] = value


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        quick = bool(file.attrs["quick"])
        drips = {name: dict(g.attrs) for name, g in file["drip"].items()}
        steps = {name: dict(g.attrs) for name, g in file["step"].items()} if "step" in file else {}
        rows = [method(name, drips[name], steps.get(name)) for name in METHODS if name in drips]
        if not quick:
            rows += bounds(drips, drips[next(iter(METHODS))], dict(file["wcsph"].attrs), END, DT, 100 * SPEED)
            rows += [noise(name, file[f"tank/{name}"][()]) for name in (*TANKS, "WCSPH")]
    return rows
