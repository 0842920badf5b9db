"""Incompressible liquids: ms per step of DFSPH while a dam break splashes, beside SPlisHSPlasH's, and the price of each part.

A cube of water collapses in a tank 2 edges long, 1 wide and 1.5 high until t = 0.64 s (of 39 particles of 5 cm; other sizes
after as many fall times); then steps of 4 ms (the largest: 3.3) are timed: single precision, support 2 spacings, all threads,
median of 20 and best. Both iterate until the mean compression is below 0.01 %; viscosity is 50 Pa s, its residual 0.1 %. The peer
is DFSPH of SPlisHSPlasH (package pysplishsplash; environment variable SPLISH_PYTHON names the interpreter that has it, else this one),
with the viscosity of Weiler et al. 2018. Its walls are one layer of particles, melt's are three. Milliseconds of a part are
those of the stages that it adds to the step at 10,648 particles; what it improves is measured in `slime_analytic`.
"""

import math

import h5py
import numba

from experiments import Row
from experiments.boiling_pbf_bench import ask_peer
from melt import bench_slime as bench

EDGES = (22, 39, 58)  # 10,648, 59,319 and 195,112 particles
PRICED, PEER_UP_TO = 22, 39
#: Targets [ms per step]: (edge, viscosity) -> ms, at about 20 pressure iterations on two cores.
TARGETS = {(39, 0.0): 60.0, (39, 50.0): 95.0}
KEPT = (
    "liquid wall neighbours mu precision step_ms step_ms_best pressure_iterations divergence_iterations viscous_iterations "
    "poisson_iterations pressure_ms viscous_ms lists_ms density_error"
).split()


def run(out, quick=False, say=print):
    """Time all cases (``quick``: 1,000 particles, few steps). The peer takes too long at the largest size."""
    edges, priced, steps = ((10,), 10, 3) if quick else (EDGES, PRICED, 20)
    threads = numba.get_num_threads()
    with h5py.File(out, "w") as file:
        file.attrs.update(quick=quick, threads=threads)
        missing = ""
        for edge in edges:
            for mu in (0.0, 50.0):
                found = bench.measure(bench.dam(edge**3, mu), steps=steps)
                _keep(file, "melt", edge, mu, {k: found[k] for k in KEPT}, say)
                if missing or edge > PEER_UP_TO:
                    continue
                fall = bench.SPLASH * math.sqrt(edge / 39)
                dt = bench.step_of(edge)
                given = (edge, bench.SPACING, dt, 0, math.ceil(fall / dt), steps, threads, "weiler" if mu else "dfsph")
                peer = ask_peer(*given)
                missing = peer.pop("absent", "")
                if missing:
                    say(f"SPlisHSPlasH is absent: {missing}")
                else:
                    _keep(file, "peer", edge, mu, peer, say)
        file.attrs["peer_missing"] = missing
        for name, found in bench.price(priced**3, steps=steps, say=say).items():
            file.create_group(f"part {name}").attrs.update({k: found[k] for k in (*KEPT, "part_ms")}, who="part", part=name)


def _keep(file, who, edge, mu, found, say):
    file.create_group(f"{who} {edge:03d} {mu:g}").attrs.update(found, who=who, edge=edge, mu=mu)
    say(f"{who}: {found['liquid']:,} particles, {mu:g} Pa s: {found['step_ms']:.1f} ms per step, best {found['step_ms_best']:.1f}")


def report(path):
    """Return a row per size and viscosity, the peer's beside it, then one per part."""
    with h5py.File(path) as file:
        found = [dict(file[key].attrs) for key in file]
        threads, missing = int(file.attrs["threads"]), str(file.attrs["peer_missing"])
    timed = {(int(a["edge"]), float(a["mu"]), str(a["who"])): a for a in found if a["who"] != "part"}
    rows = []
    for (edge, mu, who), a in sorted(timed.items()):
        rows.append(_row(edge, mu, who, a, threads))
        theirs = timed.get((edge, mu, "peer"))
        if who == "peer" and (edge, mu, "melt") in timed:
            ours = timed[edge, mu, "melt"]
            rows.append(Row(
                f"{edge**3:,} liquid, {mu:g} Pa s: SPlisHSPlasH over melt", "", f"{theirs['step_ms'] / ours['step_ms']:.1f}", "", None,
                f"best over best {theirs['step_ms_best'] / ours['step_ms_best']:.1f}",
            ))
    if missing:
        rows.append(Row("SPlisHSPlasH", "", "absent", "", None, f"not compared: {missing}"))
    order = {name: k for k, (name, _, _) in enumerate(bench.PARTS)}
    for a in sorted((a for a in found if a["who"] == "part"), key=lambda a: order.get(str(a["part"]), 99)):
        rows.append(Row(
            f"part: {a['part']}", "", f"{a['part_ms']:.1f} ms per step", "", None,
            f"whole step {a['step_ms']:.1f} ms, best {a['step_ms_best']:.1f}; {_iterations(a)}",
        ))
    return rows


def _iterations(a):
    return (
        f"{a['pressure_iterations']:.0f} + {a['divergence_iterations']:.0f} iterations of pressure, {a['viscous_iterations']:.0f} of "
        f"viscosity, {a.get('poisson_iterations', 0):.0f} of the Poisson equation"
    )


def _row(edge, mu, who, a, threads):
    target = TARGETS.get((edge, mu)) if who == "melt" else None
    per = f"{a['pressure_ms']:.2f} and {a['viscous_ms']:.2f} ms each, lists and gradients {a['lists_ms']:.1f} ms; " if who == "melt" else ""
    return Row(
        f"{a['liquid']:,} liquid, {mu:g} Pa s, {'melt' if who == 'melt' else 'SPlisHSPlasH'}", "",
        f"{a['step_ms']:.1f} ms per step, best {a['step_ms_best']:.1f}",
        f"<= {target:g} ms" if target else "", bool(a["step_ms"] <= target) if target else None,
        f"{_iterations(a)}; {per}{a['neighbours']:.0f} neighbours, {a['wall']:,} wall particles, {threads} thread(s), single precision",
    )
