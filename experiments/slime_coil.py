"""Slime: when threads and sheets buckle on a plate, and how fast they fold and coil (slime spec 5, scene A)

Threads of `honey_coil` (round) and sheets of `honey_coil_small` (in the plane), 12 mm wide, of the full method. Onset after
Tome and McKee: a sheet buckles for H/d > 8.8 and Re = rho U d/mu < 0.56, a round thread for H/d > 7.2 and Re < 1.2; looked at
25 % away from each line, at 1 m/s. Buckled means that the axis, where it lands, comes back by half the width from its
farthest point. Frequencies are of threads that fall by their weight, at 0.2 m/s. Bending balances weight over a length
(nu a^2 U1/g)^(1/4), whence the frequency 2 pi f = (g Q^3/(nu a^8))^(1/4) of a coil and (g q^3/(nu h^5))^(1/4) of a fold; a and h are
the radius and the thickness at contact, from the flow Q = pi a^2 U1 or q = h U1 and the speed U1 there. An exponent is that of f a^2
or f h^(5/4) between two runs in which one of nu, Q and the height H differs. Viscosity: 150 Pa s unless given.
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
    f"{'sheet' if flat else 'thread'}, H/d {tall:.3g}, Re {Re:.3g}": (flat, tall, Re, buckles)
    for flat, height, most in ((True, 8.8, 0.56), (False, 7.2, 1.2))
    for tall, Re, buckles in (
        (1.25 * height, 0.75 * most, True), (0.75 * height, 0.75 * most, False), (1.25 * height, 1.25 * most, False),
    )
}
BASE = {"mu": 150.0, "speed": 0.2, "height": 0.12, "spacing": 0.002}
CHANGES = {"as it is": {}, "mu 225": {"mu": 225.0}, "0.28 m/s": {"speed": 0.28}, "H 90 mm": {"height": 0.09}}
FREQUENCY = {
    f"{kind}, {name}": (kind == "sheet", {**BASE, **change}) for kind in ("sheet", "thread") for name, change in CHANGES.items()
}
FINER = 1.5  # times as fine a lattice
FREQUENCY["sheet, finer"] = (True, {**BASE, "spacing": BASE["spacing"] / FINER})


def scene_of(flat, end, mu, speed, height, spacing, dt=0.002):
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
    slow = (rate > 1.5 / (t[-1] - t[0])) & (rate < 20)
    peak = np.flatnonzero(slow)[both[slow].argmax()]
    return float(rate[peak]), float(abs(power[peak] - power[-peak]) / both[peak])


def onset(flat, tall, Re, end=0.4):
    """Return how a sheet or a thread at 1 m/s lands in the ``end`` [s] after it has come down."""
    speed, height = 1.0, tall * WIDTH
    scene = scene_of(flat, round(height / speed + end, 3), RHO * speed * WIDTH / Re, speed, height, BASE["spacing"], 0.001)
    return follow(scene)


def frequency(flat, values, end):
    """Return how a sheet or a thread lands in ``end`` [s], and the frequency [Hz] of the scaling law."""
    found = follow(scene_of(flat, end, **values))
    nu, U, U1 = values["mu"] / RHO, values["speed"], found["contact"]
    if flat:
        flow = U * WIDTH
        thin = flow / U1
        law = (G * flow**3 / (nu * thin**5)) ** 0.25
    else:
        flow = U * math.pi * WIDTH**2 / 4
        thin = math.sqrt(flow / (math.pi * U1))
        law = (G * flow**3 / (nu * thin**8)) ** 0.25
    return {**found, "law": law / (2 * math.pi), "thin": thin}


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: the first of each kind, for a moment."""
    cases = {name: (onset, (*c[:3], 0.05 if quick else 0.4)) for name, c in ONSET.items()}
    cases |= {name: (frequency, (*c, 0.3 if quick else 2.5 if c[0] else 1.4)) for name, c in FREQUENCY.items()}
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
    for name, (flat, _) in FREQUENCY.items():
        if name in found:
            t, foot = found[name]["times"], found[name]["lateral"]
            found[name]["rate"], found[name]["one_way"] = (folds(t, foot, WIDTH / 2)[1], math.nan) if flat else swing(t, foot)
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
    for name, (flat, _) in FREQUENCY.items():
        if name in found:
            f = found[name]
            note = f"law {f['law']:.2f} Hz, {'thickness' if flat else 'radius'} at contact {1e3 * f['thin']:.2f} mm; "
            note += "" if flat else f"{100 * f['one_way']:.0f} % goes round one way; "
            rows.append(Row(f"{name}: frequency over the law's", "O(1)", f"{f['rate'] / f['law']:.2f} ({f['rate']:.2f} Hz)", "", None,
                            note + _told(f)))
    return rows + (exponents(found) if claims else [])


def _told(f):
    told = f"{f['particles']} particles, {f['steps']:.0f} sub-steps of {f['iterations']:.0f} iterations, {f['reached']:.2f} s"
    return told + (f"; stopped: {f['failed']}" if f["failed"] else "")


def exponents(found):
    """Return the rows of the exponents, and of what a finer lattice changes."""
    rows = []
    for kind, power in (("sheet", 1.25), ("thread", 2.0)):
        def free(name):
            return found[name]["rate"] * found[name]["thin"] ** power  # noqa: B023

        base = free(f"{kind}, as it is")
        for name, what, ratio, expected in (
            ("mu 225", "viscosity", 1.5, -0.25), ("0.28 m/s", "flow", 1.4, 0.75), ("H 90 mm", "height", 0.75, 0.0),
        ):
            measured = math.log(free(f"{kind}, {name}") / base) / math.log(ratio)
            rows.append(Row(f"{kind}: exponent in {what}", f"{expected:g}", f"{measured:.3f}", "within 0.1",
                            bool(abs(measured - expected) <= 0.1)))
    finer, coarse = (found[f"sheet, {name}"] for name in ("finer", "as it is"))
    change = finer["rate"] / finer["law"] / (coarse["rate"] / coarse["law"])
    return [*rows, Row(f"sheet: frequency over the law's, spacing / {FINER}", "1", f"{change:.3f} times", "within 15 %",
                       bool(abs(change - 1) <= 0.15))]
