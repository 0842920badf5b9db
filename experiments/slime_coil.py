"""Slime: when threads and sheets buckle on a plate, and how fast they fold and coil (slime spec 5, scene A)

Threads of `honey_coil` (round) and sheets of `honey_coil_small` (in the plane), 12 mm wide, of the full method. Onset after
Tome and McKee: a sheet buckles for H/d > 8.8 and Re = rho U d/mu < 0.56, a round thread for H/d > 7.2 and Re < 1.2; looked at
25 % away from each line, at 1 m/s. Buckled means that the axis, where it lands, comes back by half the width from its
farthest point. Frequencies are of sheets at 0.2 m/s (150 Pa s, 120 mm) and of threads at 1 m/s (20 Pa s, 108 mm), and of each with
another viscosity, flow or height. What folds and coils near the plate turns at f = U1/H where viscosity alone rules (viscous regime), at
2 pi f = (g Q^3/(nu a^8))^(1/4) for a thread and (g q^3/(nu h^5))^(1/4) for a sheet where weight bends it (gravitational); a and h are
radius and thickness at contact, from the flow Q = pi a^2 U1 or q = h U1 and the speed U1 there. The regime is the one whose law spreads
least over the runs; an exponent is that of f a^2 (sheets: f h, or f h^(5/4)) between two runs.
"""

import math
import tomllib

import h5py
import numpy as np

from experiments import Row
from experiments._slime_measures import Landing, entered, folds
from melt.errors import MeltError
from melt.physics.phases import LIQUID
from melt.scene import scene_from_dict
from melt.scene.load import find_scene
from melt.simulation import Simulation

WIDTH, RHO, G = 0.012, 1400.0, 9.81
#: name: (flat, H/d, Re, whether it must buckle)
ONSET = {
    f"{'sheet' if flat else 'thread'}, H = {tall:.3g} d, Re {Re:.3g}": (flat, tall, Re, buckles)
    for flat, height, most in ((True, 8.8, 0.56), (False, 7.2, 1.2))
    for tall, Re, buckles in (
        (1.25 * height, 0.75 * most, True), (0.75 * height, 0.75 * most, False), (1.25 * height, 1.25 * most, False),
    )
}
SHEET = {"mu": 150.0, "speed": 0.2, "height": 0.12, "spacing": 0.002, "dt": 0.002, "end": 2.5}
THREAD = {"mu": 20.0, "speed": 1.0, "height": 0.108, "spacing": 0.002, "dt": 0.001, "end": 0.6}
#: name: (value changed, factor)
CHANGES = {"as it is": ("mu", 1.0), "viscosity": ("mu", 1.5), "flow": ("speed", 1.4), "height": ("height", 0.75)}
#: name: (flat, what `scene_of` takes)
FREQUENCY = {
    f"{kind}, {name}": (kind == "sheet", {**base, key: factor * base[key]})
    for kind, base in (("sheet", SHEET), ("thread", THREAD)) for name, (key, factor) in CHANGES.items()
}
FINER = 1.5  # times as fine a lattice
FREQUENCY["sheet, finer"] = (True, {**SHEET, "spacing": SHEET["spacing"] / FINER})
#: regime: exponents of f a^power in viscosity, flow and height
REGIMES = {"viscous": (0.0, 1.0, -1.0), "gravitational": (-0.25, 0.75, 0.0)}
POWER = {("viscous", True): 1.0, ("viscous", False): 2.0, ("gravitational", True): 1.25, ("gravitational", False): 2.0}


def scene_of(flat, end, mu, speed, height, spacing, dt):
    """Return the scene of a sheet (``flat``) or of a round thread that falls by ``height`` [m] onto a plate."""
    facts = tomllib.loads(find_scene("honey_coil_small" if flat else "honey_coil").read_text())
    facts["time"].update(end=end, dt=dt)
    facts["domain"].update(spacing=spacing)
    facts["domain"]["upper"][2] = height + 0.015
    facts["viscosity"]["mu"] = mu
    facts["inflow"][0].update(position=[0.0, 0.0, height], speed=speed, layers=math.ceil(end * speed / spacing) + 4)
    return scene_from_dict(facts)


def follow(scene, every=0.01):
    """Run a scene; return how its thread lands: times [s], lateral positions [m], speed at contact [m/s], what stopped it."""
    sim = Simulation(scene, "cpu")
    axes = [0, 2] if scene.domain.dimensions == 2 else [0, 1, 2]
    landing = Landing(sim.initial.nozzles[0].count, scene.inflow[0].speed, scene.inflow[0].position[2])
    last, failed, solves, steps = -math.inf, "", 0.0, 0.0
    while sim.time < scene.time.end - 1e-9 and not failed:
        try:
            sim.step()
        except MeltError as error:
            failed = str(error)[:160]
        solves += sum(n for key, n in sim.do.notes.items() if key.endswith("_iterations"))
        steps += sim.do.notes.get("n_sub", 1)
        sim.do.notes.clear()
        if sim.time - last > every - 1e-9:
            last = sim.time
            count, number = entered(sim)
            liquid = sim.read("phase") == LIQUID
            first = number < count
            landing.look(sim.time, number[first], *(sim.read(a)[liquid][first][:, axes] for a in ("position", "velocity")))
    times, lateral = landing.line()
    return {
        "times": times, "lateral": lateral, "contact": landing.contact(), "failed": failed, "reached": sim.time,
        "particles": int((sim.read("phase") == LIQUID).sum()), "iterations": solves / max(steps, 1), "steps": steps,
    }


def swing(times, lateral):
    """Return (frequency [Hz] of the largest part of the motion of a thread's foot, how much of it goes round one way).

    The foot (n, 2) is a complex signal: what coils turns one way, and its spectrum has one side; what folds has both (0).
    """
    if len(times) < 8 or times[-1] - times[0] < 0.2:
        return math.nan, math.nan
    t = np.linspace(times[0], times[-1], 512)
    z = np.interp(t, times, lateral[:, 0]) + 1j * np.interp(t, times, lateral[:, 1])
    z = z - np.polyval(np.polyfit(t, z, 1), t)
    power = np.abs(np.fft.fft(z * np.hanning(len(t)), 16 * len(t))) ** 2
    rate = np.fft.fftfreq(len(power), t[1] - t[0])
    both = power + power[-np.arange(len(power))]
    slow = (rate > 1.5 / (t[-1] - t[0])) & (rate < 60)
    peak = np.flatnonzero(slow)[both[slow].argmax()]
    return float(rate[peak]), float(abs(power[peak] - power[-peak]) / both[peak])


def hang(flat, values):
    """Return how a sheet or a thread lands."""
    return follow(scene_of(flat, **values))


def onset(flat, tall, Re, end=0.4):
    """Return how a sheet or a thread at 1 m/s lands in the ``end`` [s] after it has come down."""
    speed, height = 1.0, tall * WIDTH
    return follow(scene_of(flat, round(height / speed + end, 3), RHO * speed * WIDTH / Re, speed, height, THREAD["spacing"], 0.001))


def laws(flat, values, contact):
    """Return (radius or thickness at contact [m], {regime: frequency of its law [Hz]})."""
    nu, U = values["mu"] / RHO, values["speed"]
    flow = U * WIDTH if flat else U * math.pi * WIDTH**2 / 4
    thin = flow / contact if flat else math.sqrt(flow / (math.pi * contact))
    heavy = (G * flow**3 / (nu * thin ** (5 if flat else 8))) ** 0.25 / (2 * math.pi)
    return thin, {"viscous": contact / values["height"], "gravitational": heavy}


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: the first of each kind, for a moment."""
    cases = {name: (onset, (*c[:3], 0.05 if quick else 0.4)) for name, c in ONSET.items()}
    cases |= {name: (hang, (flat, {**v, "end": 0.3} if quick else v)) for name, (flat, v) in FREQUENCY.items()}
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for name in (next(iter(ONSET)), next(iter(FREQUENCY))) if quick else cases:
            case, arguments = cases[name]
            found = case(*arguments)
            group = file.create_group(name)
            for key, value in found.items():
                if np.ndim(value):
                    group[key] = value
                else:
                    group.attrs[key] = value
            say(f"{name}: { {k: v for k, v in found.items() if not np.ndim(v)} }")


def report(path):
    """Return the rows of both lines, of the frequencies and of their exponents."""
    with h5py.File(path) as file:
        found = {name: {**file[name].attrs, **{key: file[name][key][:] for key in file[name]}} for name in file}
        claims = not file.attrs["quick"]
    rows = []
    for name, (_, _, _, buckles) in ONSET.items():
        if name in found:
            f = found[name]
            foot = f["lateral"].reshape(len(f["times"]), -1)[:, 0]
            turns, reach = folds(f["times"], foot, WIDTH / 2)[0], np.ptp(foot) / 2 if len(foot) else 0.0
            ok = bool((turns > 0) == buckles and not f["failed"])
            told = f"comes back {turns} times, swings by {1e3 * reach:.1f} mm"
            bound, expected = "yes or no" if claims else "", "yes" if buckles else "no"
            rows.append(Row(f"{name}: buckles", expected, told, bound, ok if claims else None, _told(f)))
    for name, (flat, values) in FREQUENCY.items():
        if name in found:
            f = found[name]
            f["thin"], f["laws"] = laws(flat, values, f["contact"])
            f["rate"], one_way = (folds(f["times"], f["lateral"], WIDTH / 2)[1], None) if flat else swing(f["times"], f["lateral"])
            told = ", ".join(f"{f['rate'] / law:.2f} of the {regime} law's" for regime, law in f["laws"].items())
            note = f"{'thickness' if flat else 'radius'} at contact {1e3 * f['thin']:.2f} mm, {f['contact']:.3f} m/s; "
            note += "" if flat else f"{100 * one_way:.0f} % goes round one way; "
            rows.append(Row(f"{name}: frequency", "", f"{f['rate']:.2f} Hz, {told}", "", None, note + _told(f)))
    return rows + ([row for kind in ("sheet", "thread") for row in exponents(kind, found)] if claims else [])


def _told(f):
    told = f"{f['particles']} particles, {f['steps']:.0f} sub-steps of {f['iterations']:.0f} iterations, {f['reached']:.2f} s"
    return told + (f"; stopped: {f['failed']}" if f["failed"] else "")


def exponents(kind, found):
    """Return the rows of a kind's regime, of its exponents, and of what a finer lattice changes."""
    runs = [found[f"{kind}, {name}"] for name in CHANGES]
    over = {regime: [f["rate"] / f["laws"][regime] for f in runs] for regime in REGIMES}
    regime = min(over, key=lambda name: max(over[name]) / min(over[name]))
    factors = ", ".join(f"{name}: {min(o):.2f} to {max(o):.2f}" for name, o in over.items())
    rows = [Row(f"{kind}: regime", "", f"{regime}", "", None, f"frequency over the law's, {factors}")]
    free = [f["rate"] * f["thin"] ** POWER[regime, kind == "sheet"] for f in runs]
    for (name, (_, factor)), value, expected in zip(list(CHANGES.items())[1:], free[1:], REGIMES[regime]):
        measured = math.log(value / free[0]) / math.log(factor)
        ok = bool(abs(measured - expected) <= 0.1)
        rows.append(Row(f"{kind}: exponent in {name}", f"{expected:g}", f"{measured:.3f}", "within 0.1", ok))
    if f"{kind}, finer" in found:
        finer = found[f"{kind}, finer"]
        change = finer["rate"] / finer["laws"][regime] / over[regime][0]
        rows.append(Row(f"{kind}: frequency over the law's, spacing / {FINER}", "1", f"{change:.3f} times", "within 15 %",
                        bool(abs(change - 1) <= 0.15)))
    return rows
