"""The parts of a run file beside its frames: units of series, readings of gauges, maps of the whole run."""

import numpy as np

from melt import diagnostics
from melt.fields import FIELDS
from melt.flood import ledger as flood_ledger
from melt.output.hdf5 import Small

SERIES = diagnostics.SERIES | flood_ledger.SERIES

_SERIES_UNITS = (
    ("time", "s"),
    ("dt", "s"),
    ("energy", "J"),
    ("heat", "J"),
    ("momentum", "kg m/s"),
    ("mass", "kg"),
    ("temperature", "degC"),
    ("speed", "m/s"),
    ("position", "m"),
    ("volume", "m^3"),
)

#: Heats: in K m^3 where a heat capacity is a volume (heat.law = paper).
_HEATS = ("thermal_energy", "latent_energy", "energy_in")


def series_unit(name, paper=False):
    """Return the unit of a series: of the ledgers' table, ms for ``ms/...``, else by the last known word in its name."""
    if paper and name in _HEATS:
        return "K m^3"
    if name in SERIES:
        return SERIES[name][0]
    if name.startswith("ms/"):
        return "ms"
    if name.startswith("force/"):
        return "N"
    words = name.replace("/", "_").split("_")
    if "error" in words:
        return "1"
    return next((unit for word in reversed(words) for known, unit in _SERIES_UNITS if word == known), "1")


def append_series(root, file, frames, series, paper):
    """Append one number to each of ``/melt/series``; what is new or missing is NaN or 0 in the other of ``frames`` frames."""
    group = root["melt/series"]
    known = {name for name, item in group.walk() if isinstance(item, Small)}
    for name in sorted(known | set(series)):
        folder, _, last = name.rpartition("/")
        parent = group.group(folder) if folder else group
        if last not in parent.children:
            whole = isinstance(series[name], (int, np.integer))
            dataset = Small(np.int64 if whole else np.float64, unit=series_unit(name, paper))
            dataset.append(file, np.full(frames, 0 if whole else np.nan))
            parent.children[last] = dataset
        dataset = parent.children[last]
        missing = np.nan if dataset.dtype.kind == "f" else 0
        dataset.append(file, series.get(name, missing))


def readings_of(root):
    """Return the rows that the gauges have so far."""
    gauges = root["melt"].children.get("gauges")
    return gauges["time"].rows if gauges else 0


def append_readings(root, file, readings):
    """Append rows to ``/melt/gauges``: name -> array (k, ...)."""
    for name, rows in readings.items():
        rows = np.asarray(rows)
        group = root.group("melt/gauges")
        if name not in group.children:
            unit = FIELDS[f"sample_{name}"].unit if f"sample_{name}" in FIELDS else "s"
            group.children[name] = Small(np.float64, rows.shape[1:], unit=unit)
        group.children[name].append(file, rows)


def readings_until(root, file, frames):
    """Return the rows of the gauges that the first ``frames`` frames have."""
    series = root["melt/series"].children.get("gauge_readings")
    if series is None or not frames:
        return 0
    return int(np.frombuffer(file.read(8, series.address + 8 * (frames - 1)), np.int64)[0])


def put_maps(root, file, arrays, attributes, units):
    """Put arrays (ny, nx) into ``/melt/maps``, in place of those of an earlier end; units: name -> unit, m unless given."""
    maps = root.group("melt/maps")
    maps.attrs = {name: np.asarray(v) if isinstance(v, list | tuple) else v for name, v in attributes.items()}
    for name, array in arrays.items():
        maps.children[name] = Small(array.dtype, array.shape[1:], unit=units.get(name, "m"))
        maps.children[name].append(file, array)
