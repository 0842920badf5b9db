"""Values over time: discharge, stage, rain. Flood spec E17."""

import csv
import io
import math
import pathlib

import numpy as np

from melt.errors import InputError

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0, "day": 86400.0}


class Hydrograph:
    """A value that is linear between the points of a table.

    Args:
        times: ascending [s]. values: in SI. after: beyond the last time its value ("hold"), or "zero".

    Before the first time the value is the first one.

    Raises:
        InputError: no points, times that do not ascend, a value that is no number.
    """

    def __init__(self, times, values, after="hold", name="table"):
        self.times, self.values = np.asarray(times, float), np.asarray(values, float)
        if not self.times.size:
            raise InputError(f"{name}: it has no points")
        wrong = np.flatnonzero(np.diff(self.times) <= 0)
        if wrong.size:
            k = int(wrong[0]) + 1
            raise InputError(f"{name}: time {self.times[k]:g} s of row {k + 1} does not exceed the one before: sort it, or remove doubles")
        bad = ~np.isfinite(self.times + self.values)
        if bad.any():
            raise InputError(f"{name}: row {int(np.argmax(bad)) + 1} is not finite")
        self.after = after

    def value(self, time):
        """Return the value at a time [s]."""
        if self.after == "zero" and time > self.times[-1]:
            return 0.0
        return float(np.interp(time, self.times, self.values))

    def integral(self, start, stop):
        """Return the integral from ``start`` to ``stop`` [s], exact for the linear pieces."""
        if stop <= start:
            return 0.0
        last = self.times[-1]
        if self.after == "zero" and stop > last:
            return self.integral(start, last) if start < last else 0.0
        inner = self.times[(self.times > start) & (self.times < stop)]
        t = np.concatenate([[start], inner, [stop]])
        v = np.interp(t, self.times, self.values)
        return math.fsum(0.5 * np.diff(t) * (v[1:] + v[:-1]))


def series_of(given, name):
    """Return the `Hydrograph` of a number or of a `melt.scene.flood.Table`.

    Raises:
        InputError: a file that cannot be read, or is no table of two columns (which line, and what is wrong).
    """
    if isinstance(given, float | int):
        return Hydrograph([0.0], [float(given)], name=name)
    if given.table is not None:
        times, values = zip(*given.table) if given.table else ((), ())
        title = f"{name}.table"
    else:
        times, values = _read(given.file, name)
        title = f"{name} file {given.file}"
    found = Hydrograph(np.array(times) * UNITS[given.time_unit], np.array(values) * given.scale, given.after, title)
    return found


def _read(path, name):
    """Return the two columns of a CSV; a header and lines that begin with # are skipped."""
    try:
        text = pathlib.Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{name}: the file {path} cannot be read ({error}): it must be a CSV of time and value") from None
    times, values = [], []
    for number, row in enumerate(csv.reader(io.StringIO(text)), 1):
        if not row or row[0].lstrip().startswith("#"):
            continue
        try:
            t, v = (float(cell) for cell in row[:2])
        except ValueError:
            if not times and number <= 2:  # a header
                continue
            raise InputError(f"{name}: line {number} of {path} is {','.join(row)!r}: it must be two numbers, time and value") from None
        times.append(t)
        values.append(v)
    return times, values
