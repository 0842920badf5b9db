"""Errors shown to users: one paragraph that says what, where and what to do."""


class MeltError(Exception):
    """A message for the user; the command line prints it without a traceback."""


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
