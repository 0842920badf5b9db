"""Trade-off of ice_cube_small and stefan_front_small: one knob at a time, error beside time (spec 7).

The error is the distance to a reference run in double precision with twice the sub-steps (`melt tradeoff`). A point on
a Pareto front is marked with the errors for which no other point is both faster and better.
"""

import pathlib

import h5py

from experiments import Row
from melt import tradeoff

SCENES = {"ice_cube_small": 100, "stefan_front_small": 60}


def run(out, quick=False, say=print):
    """Sweep both scenes (``quick``: the default and two knobs, 5 steps); plots go beside ``out``."""
    knobs = [("default", "-", []), *tradeoff.HEAT[:2]] if quick else None
    sweep(out, {scene: 5 if quick else steps for scene, steps in SCENES.items()}, knobs, say)


def sweep(out, scenes, knobs, say):
    """Sweep scenes ({name: steps}) over ``knobs`` (all that the scene has for None) into one file."""
    out = pathlib.Path(out)
    with h5py.File(out, "w") as file:
        for scene, steps in scenes.items():
            part = out.with_name(f"{out.stem}_{scene}.h5")
            tradeoff.run(scene, part, steps, knobs, say=say)
            with h5py.File(part) as source:
                source.copy(source["/"], file, name=scene)
            part.unlink()


def report(path):
    """Return one row per point."""
    rows = []
    with h5py.File(path) as file:
        for scene in file:
            g = file[scene]
            errors = list(g["error"])
            for k, knob in enumerate(g["knob"].asstr()[()]):
                failure = g["failure"].asstr()[k]
                front = [e for e in errors if g[f"front/{e}"][k]]
                rows.append(Row(
                    f"{scene}: {knob}", "", "unstable" if failure else f"{g['ms_per_step'][k]:.2f} ms per outer step", "", None,
                    failure[:120] or f"n_sub {g['n_sub'][k]}; error "
                    + ", ".join(f"{e} {g[f'error/{e}'][k]:.2g}" for e in errors)
                    + (f"; front: {', '.join(front)}" if front else ""),
                ))
    return rows
