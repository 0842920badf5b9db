"""Position based fluid: ms per step and per iteration, beside SPlisHSPlasH's.

A cube of water collapses in a box 1.5 times as long, single precision, one sub-step of 1 ms per step, all threads. Steps
are medians of 10 after 20. An iteration costs the difference between steps of 10 and of 2 iterations, divided by 8. The
peer is the PBF method of SPlisHSPlasH (package pysplishsplash; environment variable SPLISH_PYTHON names the interpreter
that has it, else this one) with the same particles and iterations. Its support radius is 2 spacings always; its walls
are one layer of particles, melt's are three, and both lists hold them. Its steps have neither XSPH nor effect precision.
"""

import json
import os
import pathlib
import subprocess
import sys

import h5py
import numba

from experiments import Row
from melt import bench

EDGES = (22, 39, 58)  # 10,648, 59,319 and 195,112 particles
SUPPORTS = (2.0, 2.5)
ITERATIONS = (10, 2)
PEER_SUPPORT = 2.0
SPACING, DT = bench.DAM_SPACING, bench.DAM_DT


def dam_break(edge, support, iterations):
    """Return the scene of edge^3 particles."""
    return bench.dam_break(edge**3, support, iterations)


def ask_peer(*given):
    """Return the figures of SPlisHSPlasH for the arguments of `_splish` as a dict, or ``{"absent": why}``.

    In a process of its own: where its window libraries do not fit the system's, importing it ends the process.
    """
    python = os.environ.get("SPLISH_PYTHON", sys.executable)
    script = pathlib.Path(__file__).with_name("_splish.py")
    try:
        done = subprocess.run([python, str(script), *map(str, given)], capture_output=True, text=True, timeout=3600)
    except OSError as error:
        return {"absent": f"{python}: {error.strerror}"}
    results = [line[7:] for line in done.stdout.splitlines() if line.startswith("RESULT ")]
    if results:
        return json.loads(results[0])
    last = done.stderr.strip().splitlines()
    return {"absent": f"{last[-1] if last else 'no message'} (exit {done.returncode})"}


def run(out, quick=False, say=print):
    """Time all cases (``quick``: 1 000 particles, one support, few steps)."""
    edges, supports, warm, steps = ((10,), SUPPORTS[:1], 2, 3) if quick else (EDGES, SUPPORTS, 20, 10)
    threads = numba.get_num_threads()
    with h5py.File(out, "w") as file:
        file.attrs.update(quick=quick, threads=threads)
        missing = ""
        for edge in edges:
            for support in supports:
                for J in ITERATIONS:
                    found = bench.time_steps(dam_break(edge, support, J), "cpu", warm, steps)
                    kept = ("step_ms", "step_ms_best", "liquid", "particles", "neighbours", "n_sub", "precision")
                    _keep(file, "melt", edge, support, J, {k: found[k] for k in kept}, say)
            for J in ITERATIONS if not missing else ():
                found = ask_peer(edge, SPACING, DT, J, warm, steps, threads)
                missing = found.pop("absent", "")
                if missing:
                    say(f"SPlisHSPlasH is absent: {missing}")
                    break
                _keep(file, "peer", edge, PEER_SUPPORT, J, found, say)
        file.attrs["peer_missing"] = missing


def _keep(file, who, edge, support, iterations, found, say):
    group = file.create_group(f"{who} {edge:03d} {support} {iterations:02d}")
    group.attrs.update(found, who=who, edge=edge, R=support, J=iterations)
    say(f"{who}: {found['liquid']:,} particles, support {support}, {iterations} iterations: {found['step_ms']:.2f} ms per step")


def report(path):
    """Return a row per size and support, one per size for the peer, and their ratio."""
    rows, steps = [], {}
    with h5py.File(path) as file:
        cases = {}
        for key in file:
            a = dict(file[key].attrs)
            cases.setdefault((int(a["edge"]), float(a["R"]), str(a["who"])), {})[int(a["J"])] = a
        threads, missing = int(file.attrs["threads"]), str(file.attrs["peer_missing"])
    many, few = ITERATIONS
    for (edge, support, who), by in sorted(cases.items()):
        if set(by) != set(ITERATIONS):
            continue
        a = by[many]
        iteration = (a["step_ms"] - by[few]["step_ms"]) / (many - few)
        steps[edge, support, who] = a["step_ms"], by[few]["step_ms"], iteration
        pairs = a["neighbours"] * a["liquid"]
        walls = a["particles"] - a["liquid"] if who == "melt" else a["wall"]
        rows.append(Row(
            f"{a['liquid']:,} liquid, support {support}, {'melt' if who == 'melt' else 'SPlisHSPlasH'}", "",
            f"{a['step_ms']:.2f} ms per step of {many} iterations, {by[few]['step_ms']:.2f} of {few}; {iteration:.3f} ms per iteration",
            "", None,
            f"{a['neighbours']:.1f} neighbours, {1e6 * iteration / pairs:.2f} ns per pair and iteration, {walls:,} wall particles, "
            f"{threads} thread(s), single precision",
        ))
    for edge, support, _ in sorted(c for c in steps if c[2] == "peer" and (*c[:2], "melt") in steps):
        theirs, ours = steps[edge, support, "peer"], steps[edge, support, "melt"]
        rows.append(Row(
            f"{edge**3:,} liquid, support {support}: SPlisHSPlasH over melt", "",
            f"{theirs[0] / ours[0]:.1f} per step of {many} iterations, {theirs[1] / ours[1]:.1f} of {few}", "", None,
            f"{theirs[2] / ours[2]:.1f} per iteration",
        ))
    if missing:
        rows.append(Row("SPlisHSPlasH", "", "absent", "", None, f"not compared: {missing}"))
    return rows
