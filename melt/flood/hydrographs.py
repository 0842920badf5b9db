"""Water that enters: values over time, and how they become whole columns at places. Flood spec E17, E19.

`Hydrograph` is a value over time. `Emitter` turns a discharge into columns in a region, `Rain` a rate into columns
over the terrain; their ``state`` is plain numbers, which a checkpoint keeps as JSON. Both owe less than one column
after each call: :math:`|\\sum V_{emitted} - \\int Q\\,dt| \\le V_p`. Columns are placed by the best of 8 candidates
(`emptiest`) with random numbers that are counted, not drawn in turn: column m of an emitter always has the same.
"""

import csv
import math
import pathlib

import numpy as np

from melt.errors import InputError, UnitError
from melt.units import QUANTITIES, unit_of

CANDIDATES = 8


class Hydrograph:
    """A value that is linear between the points of a table; two points at one time are a step.

    Args:
        times: ascending [s]. values: in SI.
        before, after: ``hold`` or ``zero``: outside of the table its end value, or 0.
        name: what messages call it.

    Raises:
        InputError: no points, times that descend, a number that is not finite.
    """

    def __init__(self, times, values, before="hold", after="hold", name="hydrograph"):
        t, v = np.array(times, dtype=np.float64).ravel(), np.array(values, dtype=np.float64).ravel()
        if t.size == 0 or t.size != v.size:
            raise InputError(f"{name}: {t.size} times and {v.size} values: give as many of both, at least one")
        if not (bad := np.isfinite(t) & np.isfinite(v)).all():
            raise InputError(f"{name}: point {int(np.argmin(bad)) + 1} is not finite: remove it, its neighbours are joined by a line")
        if (back := np.diff(t) < 0).any():
            k = int(np.argmax(back)) + 1
            raise InputError(f"{name}: time {t[k]:g} s of point {k + 1} is before {t[k - 1]:g} s of the one above: sort the table by time")
        for policy in (before, after):
            if policy not in ("hold", "zero"):
                raise InputError(f"{name}: outside of the table is {policy!r}: give 'hold' or 'zero'")
        self.times, self.values, self.name = t, v, name
        self._first = v[0] if before == "hold" else 0.0
        self._last = v[-1] if after == "hold" else 0.0
        self._sums = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (v[1:] + v[:-1]))])

    @classmethod
    def read(cls, path, time_unit="s", unit="m^3/s", quantity="discharge", before="hold", after="hold"):
        """Return the hydrograph of a text file of two columns, time and value.

        Columns are separated by commas, semicolons or blanks; a header, empty lines and lines that begin with # are
        skipped. ``unit`` is one of ``quantity`` (`melt.units`), such as ``ft^3/s`` or, of ``speed``, ``mm/h``.

        Raises:
            InputError: the file cannot be read, or a line is no pair of numbers. UnitError: not such a unit.
        """
        per_time, per_value = _factor(time_unit, "time"), _factor(unit, quantity)
        times, values = _pairs(pathlib.Path(path))
        return cls(np.array(times) * per_time, np.array(values) * per_value, before, after, str(path))

    def value(self, time):
        """Return the value at a time [s]; at a step, the one after it."""
        k = int(np.searchsorted(self.times, time, side="right")) - 1
        if k < 0:
            return float(self._first)
        if k >= self.times.size - 1:
            return float(self.values[-1] if time == self.times[-1] else self._last)
        share = (time - self.times[k]) / (self.times[k + 1] - self.times[k])
        return float(self.values[k] + share * (self.values[k + 1] - self.values[k]))

    def integral(self, start, stop):
        """Return the integral from ``start`` to ``stop`` [s]: exact, and parts add up to the whole."""
        return self._sum_to(stop) - self._sum_to(start)

    def _sum_to(self, time):
        """Return the integral from the first time of the table."""
        k = int(np.searchsorted(self.times, time, side="right")) - 1
        if k < 0:
            return float(self._first * (time - self.times[0]))
        u = time - self.times[k]
        if k >= self.times.size - 1:
            return float(self._sums[-1] + self._last * u)
        slope = (self.values[k + 1] - self.values[k]) / (self.times[k + 1] - self.times[k])
        return float(self._sums[k] + u * (self.values[k] + 0.5 * slope * u))


def _factor(unit, quantity):
    """Return the factor of a unit to SI."""
    factor, dimension = unit_of(unit)
    if dimension != QUANTITIES[quantity].dimension:
        raise UnitError(f"{unit!r} is no unit of {quantity}: give one such as that of '{QUANTITIES[quantity].example}'")
    return float(factor)


def _pairs(path):
    """Return the two columns of a text file."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read ({error}): give a text file of two columns, time and value") from None
    times, values, header = [], [], False
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        separator = next((s for s in (";", ",") if s in text), None)
        row = [c.strip() for c in next(csv.reader([text], delimiter=separator))] if separator else text.split()
        try:
            t, v = map(float, row)
        except ValueError:
            if not (times or header):
                header = True
                continue
            remedy = "write decimals with a point" if separator == ";" and "," in text else "it must be two numbers, time and value"
            raise InputError(f"{path}, line {number}: {text!r}: {remedy}") from None
        times.append(t)
        values.append(v)
    if not times:
        raise InputError(f"{path} has no line of two numbers: give columns time and value")
    return times, values


class Emitter:
    """A discharge that enters in a region as whole columns.

    Args:
        discharge: `Hydrograph` [m^3/s], nowhere negative.
        region: `Disc`, `Box`, `Line` or `Polygon`.
        volume: V_p of a column [m^3].
        seed, number: of the run, and of this emitter in it.
        direction, width, depth: with all three, columns enter at Q/(w d) along the unit vector; else at rest.
        state: ``{"since": time, "emitted": columns}``, as `state` of the run that is continued.
    """

    def __init__(self, discharge, region, volume, seed=0, number=0, direction=None, width=None, depth=None, state=None):
        if (discharge.values < 0).any():
            raise InputError(f"{discharge.name}: an inflow of {discharge.values.min():g} m^3/s: water leaves over open sides, not here")
        if not (volume > 0 and math.isfinite(volume)):
            raise InputError(f"a column of {volume:g} m^3: its volume must be positive")
        self.discharge, self.region, self.volume, self.key = discharge, region, float(volume), [int(seed), int(number)]
        self.direction, self.width, self.depth = direction, width, depth
        self.start = dict(state or {"since": 0.0, "emitted": 0})
        self.state = dict(self.start)

    def owed(self, until):
        """Return the volume [m^3] that has not entered by a time [s]."""
        return self.discharge.integral(self.state["since"], until) - self.state["emitted"] * self.volume

    def emit(self, until, most=None):
        """Return candidate places (n, 8, 2) [m] of the columns that are due, ``most`` at most; the rest stays owed."""
        due = int(self.owed(until) / self.volume + 1e-9)
        n = max(0, due if most is None else min(due, most))
        m = self.state["emitted"]
        self.state["emitted"] = m + n
        return self.region.points(_counted(self.key, m, n))

    def velocity(self, time):
        """Return the velocity (2,) [m/s] at which columns enter."""
        if self.direction is None or self.width is None or self.depth is None:
            return np.zeros(2)
        n = np.asarray(self.direction, dtype=np.float64)
        return self.discharge.value(time) / (self.width * self.depth) * n / np.hypot(*n)


class Rain:
    """A rate that falls on the terrain, gathers in coarse cells, and enters as columns at rest. Flood spec E19.

    The cell that is owed most gives the next column, so that cells take turns, and the whole owes less than one
    column however many cells there are.

    Args:
        rate: `Hydrograph` [m/s].
        lower, upper: corners of the plane [m].
        side: of a cell [m], about 5 r_0; cells at the upper edges are cut.
        volume: V_p of a column [m^3].
        weight: (ny, nx) factors on the rate, south row first; None: 1 everywhere. 0 keeps blocked ground dry.
        state: ``{"since": time, "emitted": [columns of each cell]}``.
    """

    def __init__(self, rate, lower, upper, side, volume, weight=None, seed=0, number=0, state=None):
        self.rate, self.volume, self.key = rate, float(volume), [int(seed), int(number)]
        edges = [np.append(np.arange(a, b - 1e-9 * side, side), b) for a, b in zip(lower, upper)]
        self.shape = len(edges[1]) - 1, len(edges[0]) - 1
        weight = np.ones(self.shape) if weight is None else np.asarray(weight, dtype=np.float64)
        if weight.shape != self.shape or not (weight >= 0).all() or (rate.values < 0).any():
            raise InputError(f"rain: rates and weights must not be negative, and weights have the shape {self.shape} of the cells")
        self._low = np.stack([g.ravel() for g in np.meshgrid(edges[0][:-1], edges[1][:-1])], axis=1)
        self._size = np.stack([g.ravel() for g in np.meshgrid(np.diff(edges[0]), np.diff(edges[1]))], axis=1)
        self._share = weight.ravel() * self._size.prod(axis=1)  # m^3 of a metre of rain
        self._turn = np.random.Generator(np.random.Philox(key=self.key)).permutation(len(self._share))
        self.start = dict(state or {"since": 0.0, "emitted": [0] * len(self._share)})
        self.state = dict(self.start)

    def owed(self, until):
        """Return the volume [m^3] of each cell that has not entered by a time [s]; some are ahead of the rain."""
        return self._share * self.rate.integral(self.state["since"], until) - self.volume * np.array(self.state["emitted"])

    def emit(self, until, most=None):
        """Return candidate places (n, 8, 2) [m] of the columns that are due, ``most`` at most; the rest stays owed."""
        owed = self.owed(until)
        due = int(owed.sum() / self.volume + 1e-9)
        n = max(0, due if most is None else min(due, most))
        m, cells = sum(self.state["emitted"]), np.zeros(0, np.int64)
        while len(cells) < n:
            # those within one column of the most come before any of them comes a second time
            first = self._turn[np.argsort(-owed[self._turn], kind="stable")]
            first = first[owed[first] > owed[first[0]] - self.volume][: n - len(cells)]
            owed[first] -= self.volume
            cells = np.append(cells, first)
        self.state["emitted"] = (np.array(self.state["emitted"]) + np.bincount(cells, minlength=len(owed))).tolist()
        return self._low[cells][:, None] + self._size[cells][:, None] * _counted(self.key, m, n)

    def velocity(self, time):
        """Return the velocity at which rain enters: none."""
        return np.zeros(2)


def _counted(key, first, n):
    """Return the random numbers (n, 8, 2) of columns ``first`` to first + n: 16 each, four blocks of Philox."""
    words = CANDIDATES * 2 // 4
    bits = np.random.Philox(key=key, counter=[words * first, 0, 0, 1])
    return np.random.Generator(bits).random((n, CANDIDATES, 2))


def emptiest(candidates, clearance):
    """Return the places (n, 2) of columns: of the candidates, the farthest from water and from those before it.

    Args:
        candidates: (n, 8, 2) [m]. clearance: (n, 8), the distance of each to the nearest column [m] (`entry_clearance`).
    """
    free = np.array(clearance, dtype=np.float64).reshape(candidates.shape[:2])
    places = np.empty((len(candidates), 2))
    for k, options in enumerate(candidates):
        places[k] = options[np.argmax(free[k])]
        later = candidates[k + 1 :] - places[k]
        free[k + 1 :] = np.minimum(free[k + 1 :], np.hypot(later[..., 0], later[..., 1]))
    return places
