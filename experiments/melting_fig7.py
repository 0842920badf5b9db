"""Melting paper, Figure 7: this method against Iwasaki et al. 2010 (our reconstruction of it).

The figure's numbers are not in the paper's text; its claim is that the method is clearly faster. The baseline
is a reconstruction: the same liquid, heat by forward Euler in as many sub-steps as its stability asks for, and
every connected piece of solid one rigid body. It is run with the K of the figures read as percent (K/100, where
one explicit step suffices) and literally (where it does not): the motive for an implicit heat step lies there.
"""

import h5py

from experiments import Row
from experiments.melting_table2 import measure

_COMMON = ["solver.precision=single", "time.n_sub=1", "fluid.sound_speed=legal"]
METHODS = {
    "ours (shape matching, implicit pairs or cg)": [],
    "baseline (rigid pieces, explicit heat; reconstruction)": ["solver.baseline=rigid", "heat.solver=explicit"],
}
SCALES = {"K / 100": 0.01, "K literal": 1.0}
SCENES = ("ice_cube", "four_densities")


def run(out, quick=False, say=print):
    """Time both methods in both readings of K."""
    with h5py.File(out, "w") as file:
        for scene in SCENES:
            for scale, factor in SCALES.items():
                for method, overrides in METHODS.items():
                    given = [*_COMMON, *overrides, f"heat.conductivity_scale={factor}"]
                    # literal K melts a cube in ten steps: time the first ones, before it is gone
                    found = measure(f"{scene}_small" if quick else scene, given, 3, 5)
                    stages = found.pop("stages")
                    group = file.create_group(f"{scene}/{scale}/{method}")
                    group.attrs.update(found)
                    group.attrs["heat_ms"] = sum(
                        v for k, v in stages.items() if k.startswith(("heat", "cg", "thermal"))
                    )
                    group.attrs["solid_ms"] = sum(
                        v
                        for k, v in stages.items()
                        if k.startswith(("region", "goal", "damp", "rigid", "fill", "site", "component"))
                    )
                    say(
                        f"{scene:<16}{scale:<10}{method[:24]:<26}{found['ms']:.1f} ms per step, heat {group.attrs['heat_ms']:.1f}, "
                        f"solids {group.attrs['solid_ms']:.1f}"
                    )
        file.attrs["quick"] = quick


def report(path):
    """Return one row per scene and reading of K: ours, the baseline, their ratio."""
    rows = []
    with h5py.File(path) as file:
        for scene in SCENES:
            for scale in SCALES:
                ours, base = (dict(file[scene][scale][m].attrs) for m in METHODS)
                ratio = base["ms"] / ours["ms"]
                claimed = not file.attrs["quick"]
                rows.append(
                    Row(
                        f"{scene}, {scale}",
                        "ours clearly faster",
                        f"{ours['ms']:.1f} against {base['ms']:.1f} ms per step: {ratio:.2f}x",
                        "> 1x" if claimed else "",
                        bool(ratio > 1) if claimed else None,
                        f"heat {ours['heat_ms']:.1f} against {base['heat_ms']:.1f} ms, solids {ours['solid_ms']:.1f} against "
                        f"{base['solid_ms']:.1f} ms, n_sub 1, single, {ours['neighbours']:.0f} neighbours, density error "
                        f"{ours['density_mean']:.2%} against {base['density_mean']:.2%} mean",
                    )
                )
    return rows
