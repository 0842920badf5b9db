"""Rows of `experiments.boiling_validation`, from its file."""

import numpy as np

from experiments import Row
from experiments import _boiling_bubbles as gas
from experiments import _boiling_life as life
from experiments import _boiling_periodic as periodic
from experiments import _boiling_rest as still
from melt.position_based import stiffness

DOUBLE = "double precision"


def all_rows(file):
    """Return the rows of an open file; those of a quick run claim nothing."""
    rows = []
    for make in (_density_rows, _law_rows, _rest_rows, _vortex_rows, _bubble_rows, _benchmark_rows, _run_rows):
        rows += make(file)
    return [row._replace(bound="", ok=None) for row in rows] if file.attrs["quick"] else rows


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
            expected = "3.3 (documented bad case)" if bad else ""
            rows.append(_row(f"V7 v rms / (g dt), height, {name}", expected, f"{speed}, {height}", note=note))
    return rows


def _vortex_rows(file):
    rows = []
    for name in periodic.FLOWS:
        a = file["V14"][name].attrs
        note = (f"{a['liquid']:,} liquid, periodic, U dt 0.1 d, J {a['iterations']}, {a['steps']} steps, {DOUBLE}; KE "
                f"{a['end']:.2f} of the first at the end, {a['warned']} warning(s) before the run")
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
        note = (f"{a['liquid']:,} liquid, J 4, 1 sub-step, mean of {a['starts']} places, u_t {a['law']:.3f} m/s, {DOUBLE}; "
                "the liquid that it displaces was put on top")
        rows += [
            _row(f"V16 speed in the liquid around over sqrt(g r), r = {key} d", "1", f"{relative:.3f}", "+- 0.03",
                 abs(relative - 1) <= 0.03, note),
            _row(f"V16 absolute speed over sqrt(g r), r = {key} d", "1.0-1.35", f"{speed:.3f}", "1.0-1.35", 1 <= speed <= 1.35, note),
            _row(f"V16 largest C while it rises, r = {key} d", "< 6 %", f"{a['C']:.1%}", "< 6 %", a["C"] < 0.06, note),
        ]
    up = bool((np.diff(relatives) > 0).all())
    rows.append(_row("V16 larger bubbles rise faster", "yes", "yes" if up else "no", "yes", up))
    a = file["V18"].attrs
    note = (f"{a['bubbles']} bubbles, {a['merged']} merged, {a['gone']} left the liquid, {a['liquid']:,} liquid, g 0.02 m/s^2, beta 2.5, "
            f"{a['steps']} steps, {DOUBLE}; volume at the end {a['growth']:.2f} of the first, by growth")
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
            f"Hysing case {a['case']}, C_D {a['drag']:.2f}, r = {ratio:g} d",
            f"v_max {a['top']:.3f} m/s; y(1, 2, 3 s) {say(a['truth'])} m",
            f"law {a['law']:.3f} m/s; run {a['speed']:.3f} m/s, {a['relative']:.3f} in the liquid around; y {say(a['height'])} m",
            note=f"{law}; {note}",
        ))
    rows.append(_row("Hysing: what is compared", "2-D, viscous (Re 35), free-slip sides, surface tension, deforming",
                     "3-D sphere of fixed shape, drag law, inviscid but for XSPH",
                     note="no circularity, no break-up, no surface tension in the model: rise speed and height are all it has, and "
                     "the speed is an input (C_D); no claim"))
    return rows


def _run_rows(file):
    a = file["V21"].attrs
    note = (f"kettle_small, {a['liquid']:,} liquid, {a['neighbours']:.0f} neighbours, J 4, {a['n_sub']} sub-step(s), {a['steps']} steps, "
            f"{DOUBLE}; {a['boiled']} boiled, {a['merged']} merged, {a['burst']} burst")
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
    rows.append(_row("V25 particles boiled by superheat of the heater", "0 up to 0 K, then ever more", said, "0, then rising",
                     cold and rises, f"kettle_small at 99 degC, {found[0]['steps']} steps, {DOUBLE}; the model has no onset superheat and "
                     "no film boiling"))
    for name in life.LITERAL:
        a = file["V26"][name].attrs
        rows.append(_row(
            f"V26 boiled in 2 s, mean temperature; preset paper, {name}", "79 %, 20.0 degC",
            f"{a['gone']:.1%}, {a['temperature']:.1f} degC",
            "> 60 %, < 25 degC", a["gone"] > 0.6 and a["temperature"] < 25,
            f"{a['liquid']:,} liquid at 20 degC, J 4, {a['n_sub']} sub-step(s), {a['precision']} precision, {a['seeds']} seeds; "
            f"largest bubble {a['largest']:.1f} d",
        ))
    return rows
