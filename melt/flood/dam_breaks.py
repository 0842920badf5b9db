"""Exact solutions of dam breaks: on dry ground (Ritter 1892) and on water (Stoker 1957). g = 9.81 m/s^2 unless given."""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

G = 9.81


class Flow(NamedTuple):
    """A solution at places of shape S."""

    depth: np.ndarray  # S, [m], 0 where dry
    velocity: np.ndarray  # S in one dimension, S + (2,) in two [m/s], 0 where dry
    bed: np.ndarray  # S, [m]


class Bore(NamedTuple):
    """The states that a dam break on wet ground joins."""

    depth: float  # h2 [m], between fan and shock
    velocity: float  # u2 [m/s]
    shock: float  # s [m/s]


def _similarity(x, t):
    """Return xi = x/t [m/s]; at t = 0 it is infinite on either side of the dam."""
    with np.errstate(over="ignore"):
        return np.asarray(x, float) / np.maximum(np.asarray(t, float), 1e-300)


def _fan(xi, c):
    """Return depth times g [m^2/s^2] and velocity [m/s] of the fan at xi, for a celerity c of the water at rest."""
    return (2 * c - xi) ** 2 / 9, 2 / 3 * (c + xi)


def ritter(x, t, h1, g=G):
    """Return the dam break on dry ground, dam at x = 0: d = (2c - xi)^2/9g, u = 2/3 (c + xi), -c < xi < 2c, c = sqrt(g h1)."""
    c = math.sqrt(g * h1)
    xi = _similarity(x, t)
    gd, u = _fan(np.clip(xi, -c, 2 * c), c)
    return Flow(gd / g, np.where(xi < 2 * c, u, 0.0), np.zeros_like(xi))


def bore(h1, h0, g=G):
    """Return the middle state of `stoker`: 2(sqrt(g h1) - sqrt(g h2)) = (h2 - h0) sqrt(g (h2 + h0)/(2 h2 h0)), s = u2 h2/(h2 - h0)."""
    if not 0 < h0 < h1:
        raise ValueError(f"needs 0 < h0 < h1, not h0 = {h0}, h1 = {h1}")

    def behind_fan(h):
        return 2 * (math.sqrt(g * h1) - math.sqrt(g * h))

    h2 = brentq(lambda h: behind_fan(h) - (h - h0) * math.sqrt(0.5 * g * (h + h0) / (h * h0)), h0, h1, xtol=1e-15 * h1)
    u2 = behind_fan(h2)
    return Bore(h2, u2, u2 * h2 / (h2 - h0))


def stoker(x, t, h1, h0, g=G):
    """Return the dam break on water of depth ``h0`` < ``h1``, dam at x = 0: fan, middle state, shock."""
    h2, u2, s = bore(h1, h0, g)
    c1 = math.sqrt(g * h1)
    xi = _similarity(x, t)
    gd, u = _fan(np.clip(xi, -c1, u2 - math.sqrt(g * h2)), c1)
    behind = xi < s
    return Flow(np.where(behind, gd / g, h0), np.where(behind, u, 0.0), np.zeros_like(xi))
