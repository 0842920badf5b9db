"""Flood: the terrain velocity control force, on against off (VC1-VC8, Figures 8 and 9).

What the control force must not do (VC1-VC8 of the flood specification, section 3), what it does at a cliff, and what it costs.
The cliff: a plateau at 10 m with water 1 m deep and 20 m long, a cosine drop over 5 m (steepest slope 3.1), a pit of 2 m, a plain;
columns 0.25 m apart, 12 s; energies count from the bottom of the pit. Discharge over the edge is that of Ritter's dam break,
8/27 h sqrt(g h), as long as the wave that runs back has not met the wall. "expected" are figures of the specification's 1-D prototype
where its table has them. Figure 8 is run on noise of the paper's size, since its terrain is not public; metrics are the worst of
all frames. Rows without a bound show what the force costs.
"""

import math

import h5py
import numpy as np

from experiments import Row
from experiments import _flood_control as control
from experiments._flood_control_rows import all_rows


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: small and short, nothing is judged."""
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick

        def keep(name, **values):
            file.require_group(name).attrs.update(values)
            say(f"{name}: " + ", ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in values.items()))

        for case in (_gentle, _single, _cliff, _figures):
            case(keep, quick)


def _gentle(keep, quick):
    for name, scene in control.gentle(quick).items():
        keep(f"VC2/{name}", **control.identical(scene))
    size = {"r0": 0.1, "periods": 0.1} if quick else {}
    t, off = control.steep_bowl(None, **size)
    _, on = control.steep_bowl({}, **size)
    exact = 0.5 * np.cos(math.sqrt(2 * control.G * 0.5) * t)
    keep("VC2/steep bowl", off=float(np.abs(off - exact).max() / 0.5), on=float(np.abs(on - exact).max() / 0.5))


def _single(keep, quick):
    for slope in (1.0, 3.0):
        keep(
            f"VC4/{slope:g}",
            free=control.bead_acceleration(slope, None),
            on=control.bead_acceleration(slope, control.ALWAYS),
        )
    keep("VC3", rest=float(np.abs(control.water(control.bead(1.0, control.ALWAYS, steps=1), "brake")[0]).max()))
    keep("VC5", **{f"dt{k}": control.brake_after(0.02 / 2**k) for k in range(3)})
    end = ["time.end=0.5"] if quick else ["time.end=4"]
    for mode in ("descent", "paper"):
        scene = control.load_scene("rough_terrain", [*end, "fluid.spacing=3", f"control.mode={mode}"], "small")
        keep(f"VC6/{mode}", gain=control.gains(scene))


def _cliff(keep, quick):
    size = {"r0": 0.5, "cell": 0.5, "end": 1.0} if quick else {}
    for name, given in control.VARIANTS.items():
        keep(f"cliff/{name}", **control.over_cliff(given, **size))
    if quick:
        return
    for spread in (0.5, 0.1):
        keep(f"spread/{spread:g}", **control.over_cliff({"spread": spread}))
    for r0 in (0.5, 0.25, 0.125):
        for name in ("off", "own point", "4 points, l <= 2 r0"):
            keep(f"sheer/{name}/{r0:g}", r0=r0, **control.over_cliff(control.VARIANTS[name], 0.0, 0.25, r0, 6.0))


def _figures(keep, quick):
    for name, overrides in (("off", ["control=none"]), ("on", ["control.spread=1"]), ("near", [])):
        keep(f"rough/{name}", **control.rough(overrides, quick))
    keep("obstacles/small", **control.inside_obstacles(quick))
    if not quick:
        keep("obstacles/full", **control.inside_obstacles(False, 1.0))


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        rows = all_rows(file)
        return [Row(*row[:3], "", None, row.note) for row in rows] if file.attrs["quick"] else rows
