"""Numbers that a step page reads back from a backend and decides by."""

import math

import numpy as np

from melt.errors import NotFinite


def finite(value):
    """Return a number, or raise `NotFinite`: nothing is decided by a number that is none."""
    if not math.isfinite(value):
        raise NotFinite
    return value


def total(do, name):
    """Return the sum over a field of partial sums."""
    return finite(_exact_sum(np.asarray(do.read(name), dtype=np.float64).ravel()))


def _exact_sum(values):
    try:
        return math.fsum(values)
    except (ValueError, OverflowError):  # infinities of both signs, or too large
        return math.nan


def largest(do, name):
    """Return the largest value of a field of partial maxima, at least 0."""
    return finite(float(np.max(do.read(name), initial=0.0)))
