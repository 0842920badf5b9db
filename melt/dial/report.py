"""Lines, HDF5 and plot of a study."""

import h5py
import numpy as np

from melt.forecast import in_words
from melt.output.errors import output_error
from melt.output.info import size
from melt.scene.fronts import MEASURED


def opening(scene, facts, candidates, seconds):
    """Return the lines before the first run: what is compared, and about how long it takes."""
    yield f"{scene.scene.name}: {facts['steps']} outer steps of {scene.time.dt:g} s; error: {facts['error']}"
    yield f"reference: {facts['reference']}"
    yield f"{candidates} candidates, {facts['seeds']}; about {in_words(seconds)} on 2 free cores, and what is not cached compiles first"
    yield f"{'point':<34}{'ms/step':>9}{'s per s':>10}{'memory':>9}{'error':>10}{'spread':>10}  single errors"


def line(point, errors):
    """Return the line of one point."""
    if point.failure:
        return f"{point.point:<34}{point.failure[:100]}"
    single = ", ".join(f"{name} {percent(100 * value)}" for name, value in errors.items())
    return (
        f"{point.point:<34}{point.ms_per_step:>9.2f}{point.s_per_simulated_s:>10.3g}{size(point.bytes):>9}"
        f"{percent(point.error):>10}{percent(point.spread):>10}  {single}"
    )


def closing(front):
    """Return the lines after the last run: the front and the presets."""
    ranked = sorted((p for p in front.points if p.on_front), key=lambda p: p.s_per_simulated_s)
    yield "front: " + "; ".join(f"{p.point} ({p.s_per_simulated_s:.3g} s per s, {percent(p.error)})" for p in ranked)
    for name in MEASURED:
        point = front.preset(name)
        if point:
            yield f"{name}: {place(front, point)}"


def place(front, point):
    """Return in words where a point sits: its cost and its error beside those of the scene as it is."""
    d = front.default
    spread = f" ± {percent(point.spread)}" if np.isfinite(point.spread) else ""
    cost = f"{point.ms_per_step:.3g} ms a step, {point.s_per_simulated_s:.3g} s per simulated second"
    error = f"error {percent(point.error)}{spread}"
    if not d.failure and point is not d:
        cost, error = f"{cost}, {ratio(point, d)} of default's", f"{error} (default {percent(d.error)})"
    return f"point {point.point!r}, {cost}; {error}"


def ratio(point, other):
    """Return the ratio of costs in words."""
    return f"{point.s_per_simulated_s / other.s_per_simulated_s:.2f}x"


def percent(value):
    """Return a number of percent in words, with three digits."""
    return f"{value:.3g} %" if np.isfinite(value) else "-"


def write(study, out):
    """Write a study to HDF5.

    Raises:
        OutputError: a full disk, no permission.
    """
    try:
        _write(study, out)
    except OSError as error:
        raise output_error("write study", out, error) from error


def _write(study, out):
    points = study.front.points
    with h5py.File(out, "w") as file:
        file.attrs.update(study.front.facts)
        for name in ("point", "failure"):
            file[name] = [getattr(p, name) for p in points]
        file["overrides"] = ["; ".join(p.overrides) for p in points]
        file["preset"] = [" ".join(p.presets) for p in points]
        for name in ("ms_per_step", "s_per_simulated_s", "bytes", "error", "spread", "on_front"):
            file[name] = [getattr(p, name) for p in points]
        for name, unit in (("error", "percent"), ("spread", "percent"), ("ms_per_step", "ms"), ("bytes", "B")):
            file[name].attrs["unit"] = unit
        file["n_sub"] = study.n_sub
        for name in study.curves:
            file[f"single/{name}"] = [100 * found.get(name, np.nan) for found in study.errors]


def plot(study, out):
    """Draw error over cost with the front; bars are the spread over seeds."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(9, 6))
    good = [p for p in study.front.points if not p.failure and np.isfinite(p.error)]
    floor = 0.5 * min((p.error for p in good if p.error > 0), default=1e-6)
    for p in good:
        y = max(p.error, floor)
        color = "#d95f02" if p is study.front.default else "#1b6ca8"
        spread = min(p.spread, 0.9 * y) if np.isfinite(p.spread) else 0.0
        ax.errorbar(p.s_per_simulated_s, y, yerr=spread, fmt="o", color=color, elinewidth=0.8, alpha=1.0 if p.on_front else 0.45)
        label = p.point + (f" [{', '.join(p.presets)}]" if p.presets else "")
        ax.annotate(label, (p.s_per_simulated_s, y), fontsize=6, xytext=(3, 3), textcoords="offset points")
    front = sorted((p.s_per_simulated_s, max(p.error, floor)) for p in good if p.on_front)
    if front:
        ax.plot(*zip(*front), "-", color="#999999", zorder=0)
    facts = study.front.facts
    ax.set(xscale="log", yscale="log", xlabel="seconds per simulated second", ylabel="error [%]")
    ax.set_title(f"{facts['scene']}: {facts['error']}\n{facts['machine']}, {facts['date']}", fontsize=7)
    ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(out, dpi=130)
    plt.close(figure)
