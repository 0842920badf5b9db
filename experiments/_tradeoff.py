"""What the trade-offs share: every candidate of the dial over a fixed number of steps, one run each, all errors beside the cost.

The dial itself (`experiments.dial`) keeps what it stores: a headline, and a spread over seeds, as far as its minutes go. Here no
candidate is left out, and each error stands alone: which curve a knob spoils.
"""

import pathlib

import h5py

from experiments import Row
from melt.dial import sweep as study
from melt.dial.systems import candidates
from melt.scene import load_scene


def sweep(out, scenes, quick, say):
    """Sweep scenes ({name: steps}) over all their knobs (``quick``: the first three candidates) into one file."""
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
