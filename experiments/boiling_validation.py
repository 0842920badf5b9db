"""Boiling: validation cases of the liquid, its bubbles and their ledgers (V5-V8, V14, V16, V18, V21, V22, V25, V26).

Expected values are those of the specification (a prototype in float64, or derived), and of the 2-D benchmark of Hysing
et al. (2009). Liquid: spacing 0.02 m, 240 steps a second, support 2.2 spacings, 4 iterations, double precision unless a
row says otherwise. C is the density error, Gamma = N g dt^2/(J d), omega' = omega/(1 + eps_rel). Rows without a bound
look for the cause of a neighbour that misses its own, or show what the model cannot do.
"""

import math

import h5py
import numba
import numpy as np

from experiments import _boiling_bubbles as gas
from experiments import _boiling_life as life
from experiments import _boiling_periodic as periodic
from experiments import _boiling_rest as still
from experiments._boiling_rows import all_rows
from melt.preflight import plan


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: small and short, nothing is judged."""
    threads = numba.get_num_threads()
    numba.set_num_threads(1)  # few particles: more threads only wait for each other (V22 takes two)
    try:
        with h5py.File(out, "w") as file:
            file.attrs["quick"] = quick
            for case in CASES:
                case(_Keeper(file, say), quick)
    finally:
        numba.set_num_threads(threads)


class _Keeper:
    """Writes figures by name, and says them."""

    def __init__(self, file, say):
        self.file, self.say = file, say

    def __call__(self, name, **values):
        self.file.create_group(name).attrs.update(values)
        self.say(f"{name}: " + ", ".join(f"{k} {_short(v)}" for k, v in values.items()))


def _short(value):
    return f"{value:.4g}" if isinstance(value, (float, np.floating)) else str(value)


def _density(keep, quick):
    edge = 6 if quick else 14
    for name, pbf in (("default", {}), ("k_s 0.1", {"push": 0.1}), ("eps_rel 0.01", {"eps_rel": 0.01})):
        keep(f"V05/{name}", rms=periodic.relax(edge, **pbf), liquid=edge**3, refused=periodic.refused(**pbf))
    for precision in ("double", "mixed", "single"):
        edge = 6 if quick else 10
        solve, blend = periodic.momentum(edge, precision)
        keep(f"V08/{precision}", solve=solve, blend=blend, liquid=edge**3)


def _column(keep, quick):
    layers, rates, counts, seconds = ((5,), (240,), (4,), 0.1) if quick else ((10, 20, 40), (120, 240, 480), (4, 8), 2.0)
    for name, pbf in still.LAW.items():
        for N in layers:
            for rate in rates:
                for J in counts:
                    scene = still.column(N, 4 if quick else 8, 1 / rate, {**pbf, "iterations": J})
                    keep(f"V06/{name}/{N} {rate} {J}", **still.rest(scene, N, seconds), layers=N, rate=rate)
    for name, (width, pbf, support) in still.RESTS.items():
        N, seconds = (5, 0.1) if quick else (20, 3.0)
        keep(f"V07/{name}", **still.rest(still.column(N, 4 if quick else width, pbf=pbf, support=support), N, seconds))


def _vortices(keep, quick):
    cells, steps = ((8, 8, 6), 4) if quick else ((32, 32, 6), 150)
    for name, (push, xsph, iterations) in periodic.FLOWS.items():
        energy = periodic.vortices(cells, steps, push, xsph, iterations)
        pbf = {"xsph": xsph, "iterations": iterations} | ({} if push is None else {"push": push})
        warned = [f.text for f in plan(still.column(4, 4, pbf=pbf)).findings if f.level == "warning"]
        keep(f"V14/{name}", most=energy.max(), end=energy[-1], viscosity=periodic.viscosity(energy, cells),
             liquid=math.prod(cells), steps=steps, iterations=iterations, warned=len(warned))


def _bubbles(keep, quick):
    cells, starts = ((6, 6, 12), 1) if quick else ((10, 10, 20), 4)
    liquid = gas.settled(gas.tank(cells), 0.1 if quick else 1.0)
    for ratio in (0.2, 0.39) if quick else (0.2, 0.39, 0.7, 1.0):
        keep(f"V16/{ratio}", **gas.risen(ratio, cells, starts, liquid))
    keep("V18", **(gas.cascade((8, 8, 12), 30, 0.5) if quick else gas.cascade((12, 12, 26), 120, 10.0)))


def _benchmark(keep, quick):
    for case, (t, y, v) in gas.benchmark().items():
        drags = {"default": 8 / 3, "fitted": gas.drag_of(case, v.max())}
        for name, drag in drags.items():
            for cells in (4,) if quick else (6, 8, 12):
                if cells == 12 and name == "fitted":
                    continue
                at, z, speed, relative = gas.hysing(case, drag, cells)
                late = at > 0.5 * at[-1]
                law = math.sqrt(8 * 0.25 * 0.98 * (1 - gas.HYSING[case] / 1000) / (3 * drag))
                height = np.where(np.array([1.0, 2.0, 3.0]) <= at[-1], np.interp([1, 2, 3], at, z), np.nan)
                keep(f"Hysing/{case} {name} {cells}", case=case, drag=drag, cells=cells, law=law, speed=speed[late].mean(),
                     relative=relative[late].mean(), height=height, end=at[-1], top=v.max(), truth=np.interp([1, 2, 3], t, y))


def _runs(keep, quick):
    keep("V21", **life.ledger(10 if quick else 480))
    hashes, boiled = life.repeats(5 if quick else 300)
    keep("V22", names=list(hashes), hashes=list(hashes.values()), steps=5 if quick else 300, boiled=boiled)
    for heater in (90.0, 115.0) if quick else life.HEATERS:
        keep(f"V25/{heater:05.1f}", **life.superheat(heater, 5 if quick else 480))
    for name, (half, n_sub, one_sided) in life.LITERAL.items():
        cells, seconds = ((4, 4, 5), 0.05) if quick else ((10, 10, 20), 2.0)
        found = [life.literal(half, n_sub, one_sided, cells, seconds, seed) for seed in ((1,) if quick else (1, 2))]
        mean = {k: float(np.mean([f[k] for f in found])) for k in ("gone", "temperature")}
        keep(f"V26/{name}", **{**found[0], **mean}, seeds=len(found))


CASES = (_density, _column, _vortices, _bubbles, _benchmark, _runs)


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        return all_rows(file)
