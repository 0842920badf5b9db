"""Words that all systems share: what a candidate is, and what its error is compared with."""

from typing import NamedTuple

import numpy as np


class Knob(NamedTuple):
    """A candidate: one knob turned, or several ("combined")."""

    name: str
    value: str
    overrides: tuple = ()

    @property
    def label(self):
        """The name of its point."""
        return f"{self.name} {self.value}".strip()


class Measure(NamedTuple):
    """What the headline error of a scene is.

    ``floors``: {curve: unit of its error, at least}; a curve is judged by its root mean square distance from the reference
    run's over the larger of that and of the change of the reference's. Curves of an ``exact`` measure are errors themselves.
    """

    words: str
    floors: dict
    exact: bool = False


def errors_of(times, curves, truth, measure):
    """Return {curve: error as a share}; ``truth`` is (times, curves) of the reference run, None for an exact measure.

    Times may differ (a knob may change the outer step): the reference is interpolated. Instants at which either is not
    finite, as when no solid is left, do not count.
    """
    if measure.exact:
        return {name: float(np.mean(curve)) for name, curve in curves.items()}
    found = {}
    for name, floor in measure.floors.items():
        if name not in curves or name not in truth[1]:
            continue
        there = np.interp(times, truth[0], truth[1][name])
        both = np.isfinite(there) & np.isfinite(curves[name])
        if both.any():
            unit = max(float(np.ptp(there[both])), floor)
            found[name] = float(np.sqrt(np.mean((curves[name] - there)[both] ** 2))) / unit
    return found


def headline(errors):
    """Return the headline error: that of the worst curve, NaN without any, or with one that is none."""
    return float(np.max([*errors.values()])) if errors else np.nan


def temperature(sim):
    """Return {"temperature": mean over the range at the start} of a scene with heat, else {}."""
    values = sim.series()
    if "temperature_mean" not in values:
        return {}
    return {"temperature": values["temperature_mean"] / max(float(np.ptp(sim.initial["temperature"])), 1.0)}
