"""Boiling: validation cases of the liquid, its bubbles and their ledgers (V5-V8, V14, V16, V18, V21, V22, V25, V26).

Expected values are those of the specification (a prototype in float64, or derived), and of the 2-D benchmark of Hysing
et al. (2009). Liquid: spacing 0.02 m, 240 steps a second, support 2.2 spacings, 4 iterations, double precision unless a
row says otherwise. C is the density error, Gamma = N g dt^2/(J d), omega' = omega/(1 + eps_rel). Rows without a bound
look for the cause of a neighbour that misses its own, or show what the model cannot do.
"""

import math

import h5py
import numpy as np

from experiments import Row
from experiments import _boiling_bubbles as gas
from experiments import _boiling_life as life
from experiments import _boiling_periodic as periodic
from experiments import _boiling_rest as still
from melt.position_based import stiffness
from melt.preflight import plan

DOUBLE = "double precision"


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: small and short, nothing is judged."""
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for case in (_density, _column, _vortices, _bubbles, _benchmark, _runs):
            case(_Keeper(file, say), quick)


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


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        judged = not file.attrs["quick"]
        rows = []
        for make in (_density_rows, _law_rows, _rest_rows, _vortex_rows, _bubble_rows, _benchmark_rows, _run_rows):
            rows += make(file)
    return rows if judged else [row._replace(bound="", ok=None) for row in rows]


def _row(name, expected, measured, bound="", ok=None, note=""):
    return Row(name, expected, measured, bound, None if ok is None else bool(ok), note)


def _density_rows(file):
    rows = []
    for name in file["V05"]:
        a = file["V05"][name].attrs
        rms, note = a["rms"], f"{a['liquid']:,} liquid, periodic, jitter 0.15 d, {DOUBLE}"
        if name == "eps_rel 0.01":
            rows.append(_row(f"V5 rms C after 4 iterations, {name}", "> 8 %, and a warning", f"{rms[3]:.1%}, scene refused: "
                             f"{'yes' if a['refused'] else 'no'}", "> 8 %, refused", rms[3] > 0.08 and a["refused"], note))
            continue
        for J, C, truth in zip(periodic.ITERATIONS, rms, periodic.RMS):
            rows.append(_row(f"V5 rms C after {J} iterations, {name}", f"{truth:.2%}", f"{C:.2%}", "+- 20 %", abs(C / truth - 1) <= 0.2,
                             note + (", k_s 0.03" if name == "default" else "; the specification's k_s")))
        rows.append(_row(f"V5 rms C falls from iteration to iteration, {name}", "yes", "yes" if (np.diff(rms) < 0).all() else "no", "yes",
                         (np.diff(rms) < 0).all(), note))
    for precision in file["V08"]:
        a, bound = file["V08"][precision].attrs, 1e-14 if precision == "double" else 1e-6
        for what, value in (("solve", a["solve"]), ("XSPH", a["blend"])):
            rows.append(_row(f"V8 momentum of {what}, {precision}", "0", f"{value:.1e}", f"<= {bound:g} of the sum of absolute values",
                             value <= bound, f"{a['liquid']:,} liquid, periodic, random m, V, R (1.8-2.2 d), J (2-4)"))
    return rows


def _law_rows(file):
    rows, slow = [], stiffness(2.2).slow
    for name in file["V06"]:
        for key in sorted(file["V06"][name], key=lambda k: [int(w) for w in k.split()]):
            a = file["V06"][name][key].attrs
            gamma = a["layers"] * still.G / a["rate"] ** 2 / (a["iterations"] * still.D)
            factor = a["C"] / (gamma / (0.5 * slow))
            rows.append(_row(
                f"V6 bottom C over Gamma/(omega' c2), {a['layers']} layers, 1/{a['rate']} s, J {a['iterations']}, {name}", "0.86",
                f"{factor:.3f}", "+- 0.15", abs(factor - 0.86) <= 0.15,
                f"C {a['C']:.2%} (law {a['law']:.2%}), v rms {a['speed']:.2f} g dt, {a['liquid']:,} liquid, {a['neighbours']:.0f} "
                f"neighbours, {a['steps']} steps, {DOUBLE}",
            ))
    return rows


def _rest_rows(file):
    rows = []
    for name in still.RESTS:
        a = file["V07"][name].attrs
        note = (f"{a['liquid']:,} liquid, {a['neighbours']:.0f} neighbours, J {a['iterations']}, 1 sub-step, {a['steps']} steps, {DOUBLE}; "
                f"bottom C {a['C']:.2%}, largest {a['most']:.1%}")
        speed, height = f"{a['speed']:.2f}", f"{a['height']:.4f}"
        if name in ("default", "effect precision"):
            drift, within = 100 * a["drift"], 0.93 <= a["height"] <= 0.96
            rows += [
                _row(f"V7 v rms / (g dt), {name}", "0.22", speed, "<= 0.5", a["speed"] <= 0.5, note),
                _row(f"V7 mean height over the lattice's, {name}", "0.93-0.96", height, "0.93-0.96", within, note),
                _row(f"V7 drift of the height, {name}", "0", f"{drift:.3f} %/s", "< 0.5 %/s", abs(drift) < 0.5, note),
                _row(f"V7 particles outside, {name}", "0", str(a["outside"]), "0", a["outside"] == 0, note),
            ]
        else:
            bad = name.startswith("one-sided")
            rows.append(_row(f"V7 v rms / (g dt), height, {name}", "3.3 (documented bad case)" if bad else "", f"{speed}, {height}", note=note))
    return rows


def _vortex_rows(file):
    rows = []
    for name in periodic.FLOWS:
        a = file["V14"][name].attrs
        note = (f"{a['liquid']:,} liquid, periodic, U dt 0.1 d, J {a['iterations']}, {a['steps']} steps, {DOUBLE}; KE {a['end']:.2f} of the first "
                f"at the end, {a['warned']} warning(s) before the run")
        energy, nu = f"{a['most']:.3f}", f"{a['viscosity']:.4f}"
        if name in ("k_s 0", "1 iteration"):
            wants = "1.9" if name == "k_s 0" else "explodes"
            rows.append(_row(f"V14 largest KE over the first, {name}", f"{wants}, warning", energy, "warned", a["warned"] > 0, note))
            continue
        rows.append(_row(f"V14 largest KE over the first, {name}", "<= 1.01", energy, "<= 1.01", a["most"] <= 1.01, note))
        rows.append(_row(f"V14 viscosity / U L, {name}", "0.054", nu, "0.03-0.07", 0.03 <= a["viscosity"] <= 0.07,
                         note + ("; XSPH alone: 0.0036" if name == "default" else "")))
    return rows


def _bubble_rows(file):
    rows, relatives = [], []
    for key in sorted(file["V16"], key=float):
        a = file["V16"][key].attrs
        relative, speed = a["relative"] / a["law"], a["speed"] / a["law"]
        relatives.append(a["relative"])
        note = f"r = {key} d, {a['liquid']:,} liquid, {a['starts']} places, u_t {a['law']:.3f} m/s, {DOUBLE}; liquid above it was displaced to the top"
        rows += [
            _row(f"V16 speed in the liquid around over sqrt(g r), r = {key} d", "1", f"{relative:.3f}", "+- 0.03", abs(relative - 1) <= 0.03, note),
            _row(f"V16 absolute speed over sqrt(g r), r = {key} d", "1.0-1.35", f"{speed:.3f}", "1.0-1.35", 1 <= speed <= 1.35, note),
            _row(f"V16 largest C while it rises, r = {key} d", "< 6 %", f"{a['C']:.1%}", "< 6 %", a["C"] < 0.06, note),
        ]
    up = bool((np.diff(relatives) > 0).all())
    rows.append(_row("V16 larger bubbles rise faster", "yes", "yes" if up else "no", "yes", up))
    a = file["V18"].attrs
    note = (f"{a['bubbles']} bubbles, {a['merged']} merged, {a['gone']} left, {a['liquid']:,} liquid, g 0.02 m/s^2, beta 2.5, {a['steps']} steps, "
            f"{DOUBLE}; volume at the end {a['growth']:.2f} of the first, by growth")
    rows += [
        _row("V18 cargo missing after 10 s of merging", "0 quarters", f"{a['cargo_missing']}", "0", a["cargo_missing"] == 0, note),
        _row("V18 volume changed by a merging (largest)", "0", f"{a['volume_error']:.1e}", "<= 1e-13", a["volume_error"] <= 1e-13, note),
    ]
    return rows


def _benchmark_rows(file):
    rows = []
    for key in file["Hysing"]:
        a = file["Hysing"][key].attrs
        fitted = "fitted" in key
        say = lambda values: ", ".join("-" if np.isnan(v) else f"{v:.3f}" for v in values)  # noqa: E731
        ratio = 0.25 * a["cells"]
        note = f"sphere of r = {ratio:g} d in a box of {a['cells']} x {a['cells']} x {2 * a['cells']} spacings, {DOUBLE}"
        if ratio > gas.REACH:
            note += "; no liquid within the support of a bubble larger than it: no drag, free acceleration"
        law = "C_D fitted to the benchmark's largest speed" if fitted else "C_D 8/3: sqrt(g r)"
        rows.append(_row(
            f"Hysing case {a['case']}, C_D {a['drag']:.2f}, r = {ratio:g} d", f"v_max {a['top']:.3f} m/s; y(1, 2, 3 s) {say(a['truth'])} m",
            f"law {a['law']:.3f} m/s; run {a['speed']:.3f} m/s, {a['relative']:.3f} in the liquid around; y {say(a['height'])} m", note=f"{law}; {note}",
        ))
    rows.append(_row("Hysing: what is compared", "2-D, viscous (Re 35), free-slip sides, surface tension, deforming",
                     "3-D sphere of fixed shape, drag law, inviscid but for XSPH", note="no circularity, no break-up, no surface tension in the model: "
                     "rise speed and height are all it has, and the speed is an input (C_D); no claim"))
    return rows


def _run_rows(file):
    a = file["V21"].attrs
    note = (f"kettle_small, {a['liquid']:,} liquid, {a['neighbours']:.0f} neighbours, J 4, {a['n_sub']} sub-step(s), {a['steps']} steps, {DOUBLE}; "
            f"{a['boiled']} boiled, {a['merged']} merged, {a['burst']} burst")
    rows = [_row("V21 quarters of a particle missing", "0", str(a["quarters"]), "0", a["quarters"] == 0, note),
            _row("V21 heat missing over that of the start", "0", f"{a['heat']:.1e}", "<= 1e-10", a["heat"] <= 1e-10, note)]
    a = file["V22"].attrs
    hashes, note = dict(zip(a["names"], a["hashes"])), f"kettle_small, {a['steps']} steps, CPU, {DOUBLE}, {a['boiled']} boiled"
    first = hashes["1 thread"]
    for name, want in (("1 thread, again", "same bits"), ("2 threads", "same bits"), ("seed 2", "other bits")):
        if name not in hashes:
            rows.append(_row(f"V22 {name}", want, "not run: one thread only", note=note))
            continue
        got = "same bits" if hashes[name] == first else "other bits"
        rows.append(_row(f"V22 {name}", want, got, want, got == want, note))
    found = [dict(file["V25"][k].attrs) for k in sorted(file["V25"])]
    hot = [f["boiled"] for f in found if f["boiled"] > 0]
    rises, cold = bool((np.diff(hot) > 0).all() and len(hot) > 1), all(f["boiled"] == 0 for f in found if f["heater"] <= 100)
    said = ", ".join(f"{f['heater'] - 100:+g} K: {f['boiled']}" for f in found)
    rows.append(_row("V25 particles boiled by superheat of the heater", "0 up to 0 K, then ever more", said, "0, then rising", cold and rises,
                     f"kettle_small at 99 degC, {found[0]['steps']} steps, {DOUBLE}; the model has no onset superheat and no film boiling"))
    for name in life.LITERAL:
        a = file["V26"][name].attrs
        rows.append(_row(
            f"V26 boiled in 2 s, mean temperature; preset paper, {name}", "79 %, 20.0 degC", f"{a['gone']:.1%}, {a['temperature']:.1f} degC",
            "> 60 %, < 25 degC", a["gone"] > 0.6 and a["temperature"] < 25,
            f"{a['liquid']:,} liquid at 20 degC, J 4, {a['n_sub']} sub-step(s), {a['precision']} precision, {a['seeds']} seeds; largest "
            f"bubble {a['largest']:.1f} d",
        ))
    return rows
