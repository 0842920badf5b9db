"""Slime: drag on a moving square (SPHERIC benchmark 6)

A square starts to move in a closed box full of liquid, Re = 100; see `data/spheric06`. The force is what the liquid's particles get
from those of the square, turned round, by the pressure and by the viscous solve; coefficients are 2 F/(rho U^2 L), means over the
windows of the reference. The liquid has no surface: `fluid.enclosed`, pressure by ISPH alone, particles shifted
(`solver.dfsph.shift`). "No shift" shows what that is for. "Spread" is the standard deviation of the pressure drag from step to step.
"""

import csv
import pathlib

import h5py
import numpy as np

from experiments import Row
from experiments._slime_runs import settings_of, start, to

DATA = pathlib.Path(__file__).parents[1] / "data" / "spheric06"
#: Case -> (settings, end [s]).
CASES = {
    "10 across": ((), 6.125),
    "20 across": (("domain.spacing=0.05", "time.dt=5 ms"), 6.125),
    "10 across, no shift": (("solver.dfsph.shift=0",), 1.625),
    "10 across, walls as they are": (("viscosity.wall=0.5",), 6.125),
}
QUICK = {"10 across": 0.3}
STEADY = (3.0, 6.0)


def reference():
    """Return the columns of `data/spheric06/drag.csv`."""
    with open(DATA / "drag.csv") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def square(settings, end):
    """Run the scene; return drag coefficients (n, 2) [pressure, viscous] at the end of each step, and what it came to."""
    sim, drag, times = start("moving_square", *settings), [], []

    def watch(sim):
        times.append(sim.time - 0.5 * sim.scene.time.dt)  # forces are means over a step
        drag.append([-2 * sim.do.notes[f"force/square/{kind}_x"] for kind in ("pressure", "shear")])

    found = to(sim, end, watch)
    ratio = sim.read("density_ratio")[sim.read("phase") == 0]
    return {"time": np.array(times), "drag": np.array(drag), "settings": settings_of(sim, found), "seconds": found["seconds"],
            "least": float(ratio.min()), "most": float(ratio.max())}


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: the beginning of one, nothing is judged."""
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for name, (settings, end) in CASES.items():
            if quick and name not in QUICK:
                continue
            try:
                values = square(settings, QUICK.get(name, end) if quick else end)
            except Exception as error:  # it is published
                values = {"failed": f"{type(error).__name__}: {error}"[:300]}
            group = file.create_group(name)
            for key, value in values.items():
                group.attrs.update({key: value}) if np.ndim(value) == 0 else group.create_dataset(key, data=value)
            say(f"{name}: " + ", ".join(f"{k} {v}" for k, v in values.items() if np.ndim(v) == 0))


def windows(time, drag, wanted):
    """Return the mean of ``drag`` over each of the reference's windows that the run covers, else nan."""
    found, end = [], time[-1] + (time[1] - time[0])  # times are in the middle of steps
    for t, width in zip(wanted["time"], wanted["window"]):
        inside = (time > t - width / 2 + 1e-9) & (time <= t + width / 2 + 1e-9)
        found.append(drag[inside].mean(axis=0) if inside.any() and end > t + width / 2 else [np.nan, np.nan])
    return np.array(found)


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        return [row for name in CASES if name in file for row in _rows(name, file[name], file.attrs["quick"])]


def _rows(name, group, quick):
    if "failed" in group.attrs:
        claims = "no shift" not in name
        return [Row(name, "", group.attrs["failed"], "runs" if claims else "", False if claims else None)]
    wanted, time = reference(), group["time"][:]
    drag = windows(time, group["drag"][:], wanted)
    told = f"{group.attrs['settings']}; density ratio {group.attrs['least']:.2f} to {group.attrs['most']:.2f}"
    reached = np.isfinite(drag[:, 0])
    rows = []

    def row(what, expected, measured, share):
        claims = bool(share) and not quick
        bound = f"within {share:.0%}" if claims else ""
        rows.append(Row(f"{name}: {what}", f"{expected:.3g}", f"{measured:.3g}", bound,
                        bool(abs(measured / expected - 1) <= share) if claims else None, told if not rows else ""))

    judged = name in ("10 across", "20 across")
    first = reached & (wanted["time"] < 1)
    k = np.argmax(np.where(first, wanted["pressure"], 0))
    if first.any():
        row("largest pressure drag, means over 0.05", wanted["pressure"][k], drag[first, 0].max(), 0.05 if judged else 0)
    steady = reached & (wanted["time"] >= STEADY[0]) & (wanted["time"] <= STEADY[1])
    if steady.any():
        for what, column, share in (("pressure drag", 0, 0.05), ("viscous drag", 1, 0.1)):
            key = ("pressure", "viscous")[column]
            row(f"{what}, mean over t = 3 to 6", wanted[key][steady].mean(), drag[steady, column].mean(), share if judged else 0)
        total = (wanted["pressure"] + wanted["viscous"])[steady].mean()
        row("drag, mean over t = 3 to 6", total, drag[steady].sum(axis=1).mean(), 0.05 if judged else 0)
    late = time > 1
    if late.any():
        p = group["drag"][:, 0][late]
        spread = np.std(np.diff(p)) / np.sqrt(2)
        rows.append(Row(f"{name}: spread of the pressure drag from step to step, t > 1", "", f"{spread:.2g}", "", None))
    return rows
