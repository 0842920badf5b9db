"""Colours of fields: piecewise linear maps with a range and a unit. Melting spec 2.8."""

import difflib
from typing import NamedTuple

import numpy as np

from melt.output.errors import OutputError

#: cold blue, yellow, hot red
TEMPERATURE = ((0.10, 0.34, 0.86), (0.99, 0.85, 0.28), (0.85, 0.10, 0.08))
SPEED = ((0.07, 0.20, 0.55), (0.13, 0.58, 0.83), (0.62, 0.88, 0.93), (0.98, 0.99, 1.0))
OTHER = ((0.27, 0.00, 0.33), (0.19, 0.41, 0.56), (0.21, 0.72, 0.47), (0.99, 0.91, 0.14))
#: liquid, solid, wall, bubble, vapour, inactive
PHASE = np.array(
    (
        (0.16, 0.47, 0.84),
        (0.86, 0.93, 0.98),
        (0.55, 0.55, 0.57),
        (0.97, 0.97, 0.99),
        (0.80, 0.82, 0.86),
        (0.3, 0.3, 0.3),
    ),
    np.float32,
)


class Colouring(NamedTuple):
    """How one field becomes colours: ``low`` .. ``high`` over the map; phases have no range."""

    field: str
    unit: str
    low: float
    high: float
    stops: tuple

    def rgb(self, values):
        """Return colours (..., 3), float32 in 0 .. 1, of values (...)."""
        if self.field == "phase":
            return PHASE[np.asarray(values, int)]
        values = np.asarray(values, np.float64)
        span = self.high - self.low
        t = np.clip(np.nan_to_num((values - self.low) / (span if span > 0 else 1.0)), 0, 1)
        at = np.linspace(0, 1, len(self.stops))
        return np.stack([np.interp(t, at, channel) for channel in zip(*self.stops)], axis=-1).astype(
            np.float32
        )


def values_of(frame, field):
    """Return the numbers (n,) that colour a frame: a scalar field, the size of a vector one, or speed."""
    if field == "speed":
        return np.linalg.norm(frame["velocity"], axis=1)
    values = frame[field]
    return np.linalg.norm(values, axis=1) if values.ndim == 2 else values


def choose(run, field, sample=12):
    """Return the `Colouring` of a run: ``field``, or of temperature and speed what the run has in their place.

    Its range is that of the data over up to ``sample`` frames, walls left out.

    Raises:
        OutputError: the run has no such field.
    """
    has = set(run.fields)
    known = sorted({"temperature", "speed", "phase", *has} - {"position"})
    if field not in known:
        close = difflib.get_close_matches(field, known, 1)
        hint = f"did you mean {close[0]}?" if close else f"it has {', '.join(known)}"
        raise OutputError(f"the run has no field {field!r} to colour by; {hint}")
    field = next(
        (f for f in (field, "temperature") if f in has or (f == "speed" and "velocity" in has)), None
    )
    field = field or ("speed" if "velocity" in has else "phase" if "phase" in has else "position")
    if field == "phase":
        return Colouring("phase", "", 0, 1, ())
    source = "velocity" if field == "speed" else field
    low, high = np.inf, -np.inf
    for k in np.unique(np.linspace(0, len(run) - 1, min(sample, len(run))).astype(int)):
        frame = run.frame(k, [f for f in (source, "phase") if f in has])
        values = values_of(frame, field)
        if "phase" in frame:
            values = values[(frame["phase"] != 2) & (frame["phase"] != 5)]
        values = values[np.isfinite(values)]
        if len(values):
            low, high = min(low, values.min()), max(high, values.max())
    if not low <= high:
        low, high = 0.0, 1.0
    if field == "speed":
        low = 0.0
    stops = TEMPERATURE if field == "temperature" else SPEED if field == "speed" else OTHER
    return Colouring(field, run.units[source], float(low), float(high), stops)
