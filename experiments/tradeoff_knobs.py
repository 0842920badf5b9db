"""Trade-off of ice_cube_small and stefan_front_small: one knob at a time, error beside time (spec 7).

The error is the distance to a reference run in double precision with more sub-steps, that of the worst of several curves in
percent (`melt tradeoff`); what the single curves say stands in the note. "front" marks points that no other beats in both
cost and error.
"""

import pathlib

import h5py

from experiments import Row
from melt.dial import sweep as study

SCENES = {"ice_cube_small": 100, "stefan_front_small": 60}


def run(out, quick=False, say=print):
    """Sweep both scenes (``quick``: the default and two knobs, 5 steps); plots go beside ``out``."""
    sweep(out, {scene: 5 if quick else steps for scene, steps in SCENES.items()}, quick, say)


def sweep(out, scenes, quick, say):
    """Sweep scenes ({name: steps}) over all their knobs (``quick``: the first three candidates) into one file."""
    from melt.dial.systems import candidates
    from melt.scene import load_scene

    out = pathlib.Path(out)
    with h5py.File(out, "w") as file:
        for scene, steps in scenes.items():
            part = out.with_name(f"{out.stem}_{scene}.h5")
            knobs = candidates(load_scene(scene), lambda overrides, scene=scene: load_scene(scene, overrides))[: 3 if quick else None]
            study.run(scene, part, steps, within=float("inf"), seeds=1, knobs=knobs, say=say)
            with h5py.File(part) as source:
                source.copy(source["/"], file, name=scene)
            part.unlink()


def report(path):
    """Return one row per point."""
    rows = []
    with h5py.File(path) as file:
        for scene, g in file.items():
            for k, point in enumerate(g["point"].asstr()[()]):
                failure = g["failure"].asstr()[k]
                single = ", ".join(f"{name} {values[k]:.2g} %" for name, values in g["single"].items())
                found = f"{g['error'][k]:.2g} % at {g['ms_per_step'][k]:.2f} ms per outer step"
                rows.append(Row(
                    f"{scene}: {point}", "", "unstable" if failure else found, "", None,
                    failure[:120] or f"n_sub {g['n_sub'][k]}; {single}" + ("; front" if g["on_front"][k] else ""),
                ))
    return rows
