"""What a run file holds, in words: `melt info`."""

import numpy as np

from melt.ending import described
from melt.output import checkpoint
from melt.output.run_reader import open_run
from melt.physics.phases import PHASE_NAMES
from melt.watch import capsule

#: What a value does not say by its name, by solver.melt_to.
MEANING = {
    "water": {"last mass_created": " (what melts keeps its volume and takes the liquid's density; solver.melt_to = own keeps mass)"},
    "own": {"last mass_created": " (solver.melt_to = own: what melts keeps its mass)"},
}


def describe(run_path):
    """Return [(label, text)] about a run file.

    Raises:
        RunFileError: it cannot be read.
    """
    with open_run(run_path) as run:
        rows = [("file", f"{run.path}, {size(run.path.stat().st_size)}")]
        rows.append(("scene", _scene_name(run.scene_text)))
        rows += _frames(run)
        kept = checkpoint.beside(run.path)
        rows.append(("ended", described(run.end, kept.exists())))
        rows.append(
            ("fields", ", ".join(f"{name} [{unit}]" for name, unit in sorted(run.units.items())) or "none")
        )
        solids = "[[solid]]" in run.scene_text
        meaning = MEANING["own" if 'melt_to = "own"' in run.scene_text else "water"] if solids else {}
        rows += [
            (
                name.replace("_", " "),
                _value(values[-1], unit) + meaning.get(name, "") if len(values) else "",
            )
            for name, values, unit in _last_values(run)
        ]
        rows += [(name.replace("_", " "), str(value)) for name, value in run.provenance.items()]
        rows += _floods(run)
        rows.append(("checkpoint", kept.name if kept.exists() else "none"))
        if (there := capsule.beside(run.path)).exists():
            rows.append(("capsule", f"{there.name}, of the last alarm: melt check --capsule replays it"))
    return rows


def _scene_name(text):
    import tomllib

    try:
        scene = tomllib.loads(text).get("scene", {})
    except tomllib.TOMLDecodeError:
        return "not readable"
    return ": ".join(str(scene[k]) for k in ("name", "title") if k in scene) or "without a name"


def _frames(run):
    if len(run) == 0:
        return [("frames", "none yet")]
    first, last = run.times[0], run.times[-1]
    rows = [("frames", f"{len(run)}, t = {first:g} .. {last:g} s")]
    least, most = int(run.counts.min()), int(run.counts.max())
    rows.append(("particles", f"{most:,}" if least == most else f"{least:,} .. {most:,}"))
    if "phase" in run.units:
        for label, k in (("first", 0), ("last", -1)):
            number = np.bincount(run.frame(k, ["phase"])["phase"], minlength=6)
            text = ", ".join(f"{number[p]:,} {PHASE_NAMES[p]}" for p in range(6) if number[p])
            rows.append((f"{label} frame", text or "no particles"))
    return rows


def _floods(run):
    """Gauges and maps of a flood: how much was read, and the largest values."""
    rows = []
    if run.gauges:
        count = len(run.gauges["time"])
        stages = run.gauges["surface"]
        rows.append(("gauges", f"{stages.shape[1] if stages.ndim > 1 else 0}, {count} readings each"))
    for name, values in run.maps.items():
        text = f"{values.shape[1]} x {values.shape[0]} nodes"
        if np.isfinite(values).any():
            text += f", {np.nanmin(values):.6g} .. {np.nanmax(values):.6g} {run.map_units[name]}"
        rows.append((f"map {name.replace('_', ' ')}", text))
    return rows


def _last_values(run):
    """Yield (name, values, unit) of the series that say how the run went; times per stage are summed up."""
    for name in sorted(run.series):
        if "/" not in name and name != "time":
            yield f"last {name}", run.series[name], run.series_units[name]
    stages = [v for name, v in run.series.items() if name.startswith("ms/")]
    if stages and len(run):
        yield "last ms of all stages", np.nansum(stages, axis=0), "ms"


def _value(value, unit):
    return f"{value:.6g}" + (f" {unit}" if unit != "1" else "")


def size(count):
    """Return a number of bytes in words."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if count < 1000 or unit == "GB":
            return f"{count:.3g} {unit}" if unit != "bytes" else f"{count} bytes"
        count /= 1000
