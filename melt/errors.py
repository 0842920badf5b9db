"""Errors shown to users: one paragraph that says what, where and what to do."""


class MeltError(Exception):
    """A message for the user; the command line prints it without a traceback."""


class Unstable(MeltError):
    """A run that went wrong by itself: a shorter step may save it.

    ``what`` happened, ``more`` of it (where, why) and the ``remedy`` are a sentence or some each: a paragraph as text, a line
    each on the command line (``lines``). ``stage`` names one whose last call shows it, ``speed`` is the bound [m/s] that a
    particle exceeded; with neither, a value is not finite.
    """

    def __init__(self, what, *more, remedy="", stage=None, speed=None):
        self.lines = tuple(filter(None, (what, *more, remedy)))
        super().__init__(" ".join(self.lines))
        self.what, self.more, self.remedy, self.stage, self.speed = what, more, remedy, stage, speed


class NotFinite(MeltError):
    """A step page read a number back that is not finite; the simulation tells which particle."""


class SceneError(MeltError, ValueError):
    """A scene cannot be read or breaks its model."""


class GeometryError(MeltError, ValueError):
    """A shape or mesh cannot be sampled, or bodies stand in each other."""


class InputError(MeltError, ValueError):
    """A value given to the library is not finite, out of range, or too large for the precision."""


class UnitError(MeltError, ValueError):
    """A quantity has an unknown unit or one of another kind."""
