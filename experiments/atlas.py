"""Stability atlas: where each system is stable, two knobs at a time, beside the bound of its plan

Along every row the first knob (mostly the time step) grows in quarters of an octave from the predicted bound, until runs are not
stable: until they gain more than 1 % of the energy scale m (2 g H)/4, are faster than twice the fall through the liquid's height H,
are denser than a limit, move sideways at rest, leave the range of their temperatures by 0.1 %, or end in an error (not finite, not
converged). Steps are taken as long as asked for: neither sub-steps nor limits of the plan come between.
A run has 30 to 120 steps, so growth slower than that is not seen. The ratio is the first knob at the last stable run over the
predicted bound: the safety that the plan leaves; the bound is that of every moment where it follows the flow. Judged is that no
row falls below 1. A position based liquid with one iteration does at any step: the plan warns of it, but has no bound for it.
Pictures: docs/images/atlas_melting.png, atlas_boiling.png, atlas_flood.png, atlas_slime.png.
"""

import pathlib

import h5py

from experiments import Row
from melt.atlas import store, sweep
from melt.atlas.plot import plot
from melt.atlas.rows import rows_of

BLOCK = [  # of syrup that collapses on the floor, in place of the thread
    "inflow=none", "fluid.fill=[{lower=[-0.009, -1, 0], upper=[0.009, 1, 0.0144]}]", "domain.gravity=[0, 0, -9.81]",
]
#: System -> [(scene, maps, overrides)].
SYSTEMS = {
    "melting": [
        ("tank_small", None, []), ("floating_block_small", ["dt-density-ratio"], []), ("stefan_front_small", None, []),
    ],
    "boiling": [("kettle_small", None, [])],
    "flood": [
        ("stoker", ["dt-depth-ratio", "dt-alpha"], ["fluid.spacing=0.25"]),
        ("ritter", ["dt-slope", "slope-depth"], ["fluid.spacing=0.25"]),
    ],
    "slime": [("honey_coil_small", None, BLOCK)],
}
QUICK = {"melting": [("stefan_front_small", ["dt-conductivity-explicit"], [])]}


def run(out, quick=False, say=print):
    """Sweep the maps of all systems (``quick``: one map of one row); draw a picture for each."""
    out, docs = pathlib.Path(out), pathlib.Path("docs/images")
    parts = {}
    for system, sweeps in (QUICK if quick else SYSTEMS).items():
        for name, maps, overrides in sweeps:
            part = out.with_name(f"{out.stem}_{name}.h5")
            few = dict(rows=1, steps=10) if quick else {}
            sweep.run(name, part, maps, overrides, overwrite=True, say=say, picture=False, **few)
            parts.setdefault(system, []).append(part)
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for system, files in parts.items():
            for part in files:
                with h5py.File(part) as source:
                    source.copy(source["/"], file.require_group(system), name=source.attrs["scene"])
            published = docs if docs.is_dir() and not quick else out.parent
            plot(files, published / f"atlas_{system}.png", system)
    for part in sum(parts.values(), []):
        part.unlink()


def report(path):
    """Return a row per map: the least safety that the plan leaves."""
    found = []
    with h5py.File(path) as file:
        claims = not file.attrs["quick"]
        for system, scenes in file.items():
            for scene, maps in scenes.items():
                for name, group in maps.items():
                    about, cells = dict(group.attrs), store.cells_of(group)
                    found.append(_line(f"{system}, {scene}: {name}", about, rows_of(cells, about), claims))
    return found


def _line(title, about, rows, claims):
    """Return the row of a map."""
    least = min((r.stable or 0.0 for r in rows), default=0.0)
    each = "; ".join(f"{about['along']} {r.value:.3g}: {r.words} ({r.governing or 'given'})" for r in rows)
    first = next((r.first for r in sorted(rows, key=lambda r: r.stable or 0.0) if r.first is not None), None)
    why = f". First beyond: {first.grade}, {first.reason}"[:180] if first is not None else ""
    ahead = sum(r.islands for r in rows)
    note = f"predicted: {about['predicted']}. {each}{why}" + (f". {ahead} farther runs are stable again" if ahead else "")
    text = f"{least:.3g} to {max(r.stable or 0.0 for r in rows):.3g} times the bound"
    return Row(title, ">= 1", text, ">= 1" if claims else "", bool(least >= 1) if claims else None, note)
