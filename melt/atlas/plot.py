"""The picture of an atlas: per map the measured stable region, the predicted bound, and every run."""

import math

import numpy as np

from melt.atlas import store
from melt.atlas.alarms import FAILED, NOISY, REFUSED, STABLE
from melt.atlas.rows import rows_of
from melt.atlas.search import factor_of

SHADES = {STABLE: "#bfe3c8", NOISY: "#fdebb8"}
MARKS = {STABLE: ("o", "#1b7837", 22), NOISY: ("^", "#d98c00", 34), FAILED: ("x", "#b2182b", 34), REFUSED: ("s", "#777777", 26)}


def plot(paths, out, title, columns=3):
    """Draw all maps of atlas files into one picture; return its path."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    maps = []
    for path in paths:
        attrs, groups = store.read(path)
        maps += [(f"{attrs['scene']}: {name}" if len(paths) > 1 else name, *group) for name, group in groups.items()]
    wide = min(columns, len(maps))
    high = math.ceil(len(maps) / wide)
    figure, axes = plt.subplots(high, wide, figsize=(5.6 * wide, 4.7 * high), squeeze=False, layout="constrained")
    for ax, given in zip(axes.flat, maps):
        panel(ax, *given)
    for ax in axes.flat[len(maps) :]:
        ax.set_axis_off()
    figure.suptitle(f"{title}: where runs are stable, beside the bound that the plan predicts")
    figure.savefig(out, dpi=110)
    plt.close(figure)
    return out


def panel(ax, name, about, cells):
    """Draw one map."""
    rows = rows_of(cells, about)
    y = np.array([r.value for r in rows])
    x = {(c.row, c.k): r.bound * factor_of(c.k) for r in rows for c in cells if c.row == r.row}
    seen = [place for place in x.values() if place == place] or [1.0]
    left, right = min(seen) / 1.6, max(seen) * 1.6
    for grade, end in ((NOISY, "whole"), (STABLE, "stable")):
        ends = [left if (reach := getattr(r, end)) is None else r.bound * reach for r in rows]
        ax.fill_betweenx(y, left, ends, color=SHADES[grade], lw=0, zorder=0)
    ax.plot([r.bound for r in rows], y, "-", color="#08306b", lw=2, label="predicted bound", zorder=3)
    for key in (k for k in about if k.startswith("also ")):
        points = np.asarray(about[key])
        ax.plot(np.maximum(points[:, 1], left), points[:, 0], "--", color="#555555", lw=1.2, label=key[5:])
    for grade, (mark, colour, size) in MARKS.items():
        # a row that melt refuses has no bound: its runs stand at the edge
        points = [(x[c.row, c.k] if x[c.row, c.k] == x[c.row, c.k] else 1.2 * left, c.value) for c in cells if c.grade == grade]
        if points:
            ax.scatter(*zip(*points), marker=mark, c=colour, s=size, label=grade, zorder=4)
    for r in rows:
        place = dict(xycoords=("axes fraction", "data"), xytext=(-4, 7), textcoords="offset points", ha="right", fontsize=8)
        ax.annotate(r.words, (1.0, r.value), **place)
    room = (y[-1] / y[0]) ** 0.15 if len(y) > 1 else 2.0
    ax.set(xscale="log", yscale="log", xlim=(left, right), ylim=(y[0] / room, y[-1] * room))
    ax.set_xlabel(_axis(about["across"], about["across_unit"]))
    ax.set_ylabel(_axis(about["along"], about["along_unit"]))
    ax.set_title(name, fontsize=11)
    ax.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, frameon=False)


def _axis(words, unit):
    return f"{words} [{unit}]" if unit else words
