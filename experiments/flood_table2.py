"""Flood, Table 2: largest depths at gauges against measurements.

The paper compares four depths of a flood map of Iowa City with its own: 1.29/1.43, 1.51/1.65, 1.97/1.92 and 1.50/1.40
m, relative errors 9.79, 8.48, 2.60 and 7.14 %. Neither its terrain nor the places are published, and its 60 000 m^3
of water are 68 s of the river: the table cannot be repeated. The same table is made of gauges that were measured:
largest depths in the flume of the triangular sill, largest elevations above still water in the basins of Monai and of
the conical island, depths at surveyed marks of Merewether (stage less terrain, where the mark is above it). Bounds
are those of first-order finite volumes, where known; the paper's figures stand beside.
"""

import pathlib
import shutil

import h5py
import numpy as np

from experiments import Row, flood_measured
from experiments import _flood_data as data
from experiments import _flood_norms as norms
from experiments._flood_measured_rows import MARKS, note_of, series

#: Simulated and observed depth [m] of A to D.
PAPER = {"A": (1.29, 1.43), "B": (1.51, 1.65), "C": (1.97, 1.92), "D": (1.50, 1.40)}
WAVES = {"monai": ("g5", "g7", "g9"), **{f"island_{c}": ("g6", "g9", "g16", "g22") for c in "ABC"}}


def run(out, quick=False, say=print):
    """Run the measured cases; what `experiments.flood_measured` left beside ``out`` is taken as it is."""
    beside = pathlib.Path(out).with_name("flood-measured.h5")
    if beside.is_file() and beside != pathlib.Path(out):
        with h5py.File(beside, "r") as file:
            same = bool(file.attrs["quick"]) == quick
        if same:
            shutil.copyfile(beside, out)
            say(f"runs of {beside.name}")
            return
    flood_measured.run(out, quick, say)


def depths(file):
    """Return {case: (names, simulated (k,), observed (k,), finite volumes (k,) or None)} [m] of the cases of a file."""
    found = {}
    if "sill" in file:
        names = tuple(file["sill/gauges"])
        tops = [[y.max(), y_m.max()] for (_, y), (_, y_m) in (series(file["sill"], n) for n in names)]
        found["sill"] = names, *np.array(tops).T, np.array([data.TriangularSill.published["peak"][n] for n in names])
    for case, names in WAVES.items():
        if case in file:
            tops = []
            for name in names:
                (t, y), (t_m, y_m) = series(file[case], name)
                start, end = (10, 25) if case == "monai" else (t[0], t[-1])
                top = norms.peak(t, y, start, end)[0] if t[-1] > start else y.max()
                tops.append([top, norms.peak(t_m, y_m, start, end)[0]])
            bar = [data.Monai.published["peak"][n][0] for n in names] if case == "monai" else None
            found[case] = names, *np.array(tops).T, None if bar is None else np.array(bar)
    if "merewether" in file:
        curve = {k: file[f"merewether/curves/{k}"][...] for k in ("stage", "mark", "bed", "fv")}
        wet = curve["mark"] > curve["bed"]
        names = tuple(f"mark {n}" for n, keep in zip(MARKS, wet) if keep)
        depth = {k: np.maximum(curve[k] - curve["bed"], 0.0)[wet] for k in ("stage", "mark", "fv")}
        found["merewether"] = names, depth["stage"], depth["mark"], depth["fv"]
    return found


def _summary(simulated, observed):
    """Return (MAE, RMSE, bias, mean and largest relative error)."""
    off, relative = simulated - observed, norms.relative_error(simulated, observed)
    return np.abs(off).mean(), np.sqrt((off**2).mean()), off.mean(), relative.mean(), relative.max()


def report(path):
    """Return the rows; those of a quick run claim nothing."""
    rows = []
    paper = _summary(*np.array(list(PAPER.values())).T)
    beside = f"the paper's, of depths of 1.4-1.9 m elsewhere: {paper[0]:.3f}, {paper[1]:.3f}, {paper[2]:+.3f} m"
    with h5py.File(path, "r") as file:
        quick = file.attrs["quick"]
        for case, (names, simulated, observed, bars) in depths(file).items():
            title = case.replace("_", " ")
            for name, here, truth in zip(names, simulated, observed):
                error = norms.relative_error(here, truth)
                rows.append(Row(f"{title} {name}, largest", f"{truth:.4g} m", f"{here:.4g} m, {error:.1%}", "", None))
            mae, rmse, bias, relative, _ = _summary(simulated, observed)
            rows.append(_mean_row(title, relative, observed, bars, paper[3], note_of(file[case])))
            measured = f"{mae:.4f}, {rmse:.4f}, {bias:+.4f} m"
            rows.append(Row(f"{title}, MAE, RMSE, bias", beside, measured, "", None))
    return [row._replace(bound="", ok=None) for row in rows] if quick else rows


def _mean_row(title, relative, observed, bars, paper, note):
    """Return the row of the mean relative error: judged where finite volumes are known."""
    expected, bound, ok = f"the paper's, elsewhere: {paper:.1%}", "", None
    if bars is not None:
        bar = norms.relative_error(bars, observed).mean()
        expected, bound, ok = f"finite volumes {bar:.1%}; {expected}", f"<= {bar:.1%}", bool(relative <= bar)
    return Row(f"{title}, mean relative error", expected, f"{relative:.1%}", bound, ok, note)
