"""A map of the atlas: its two knobs, how it is stepped, and what counts as stable."""

import difflib
from typing import NamedTuple

import numpy as np

from melt.errors import MeltError


class Axis(NamedTuple):
    """A knob that is turned along an axis: what it is called, and the overrides that set it to any value."""

    words: str
    unit: str  # "" for a pure number
    overrides: callable  # value -> ["key=value"]
    values: callable = None  # of the second knob: number of rows -> values


class Map(NamedTuple):
    """Two knobs of a scene."""

    name: str
    along: Axis  # one row per value
    drive: callable  # see `melt.atlas.drives`
    alarms: tuple  # of `Alarm`
    base: list  # overrides of all runs
    span: float  # natural times of a run (a fall through the height of the liquid)
    predicted: str  # what the bound is, in words
    across: Axis | None = None  # the first knob; None: the time step, a multiple of the bound of now
    bound: float = 1.0  # predicted bound of a first knob that is not the time step
    also: tuple = ()  # other bounds to draw: (words, value of the second knob -> value of the first)
    octaves: int = 8  # the farthest that is looked, above the bound and half as far below
    rows: int = 4  # values of the second knob unless given
    steps: int = 120  # of a run at most unless given

    @property
    def words(self):
        """The first knob in words."""
        return "time step" if self.across is None else self.across.words

    @property
    def unit(self):
        """Unit of the first knob."""
        return "s" if self.across is None else self.across.unit


def spread(low, high):
    """Return the function of a number that gives as many values from ``low`` to ``high``, log-spaced and rounded to 3 digits."""
    return lambda number: [float(f"{v:.3g}") for v in np.geomspace(low, high, number)] if number > 1 else [float(f"{low:.3g}")]


def maps_of(scene):
    """Return the maps that apply to a scene."""
    from melt.atlas import boiling, flood, melting, slime

    systems = {"flood": flood, "slime": slime, "melting": melting, "boiling": boiling}
    return systems[scene.system].maps(scene)


def chosen(scene, names):
    """Return the maps of a scene that are named (all of them for none).

    Raises:
        MeltError: no such map; close names, or all that the scene has, are told.
    """
    known = {m.name: m for m in maps_of(scene)}
    if not known:
        raise MeltError(f"no map of the atlas applies to {scene.scene.name}: none for solids in incompressible liquids, nor for plain SPH")
    for name in names or ():
        if name not in known:
            close = difflib.get_close_matches(name, known, 1)
            hint = f"did you mean {close[0]}?" if close else f"{scene.scene.name} has {', '.join(known)}"
            raise MeltError(f"unknown map {name!r}; {hint}")
    return [known[name] for name in names or known]
