"""Circular dam break by a fine finite-volume run along the radius."""

import functools
import math

import numpy as np

from experiments._flood_exact import Flow, G
from experiments._flood_fv import DRY, hll, minmod


def radial_dam(r, t, h1, h0, radius, g=G, cells=2000):
    """Return the break of a column of water of depth ``h1`` inside ``radius`` [m], ``h0`` (may be 0) outside.

    (r d)_t + (r d u)_r = 0, (r d u)_t + (r (d u^2 + g d^2/2))_r = g d^2/2; ``cells`` per radius. Velocity: outwards.
    """
    centre, depth, velocity = _radial_run(float(t), float(h1), float(h0), float(radius), float(g), int(cells))
    r = np.abs(np.asarray(r, float))
    d = np.interp(r, centre, depth, right=h0)
    return Flow(d, np.interp(r, np.concatenate([[0.0], centre]), np.concatenate([[0.0], velocity]), right=0.0), np.zeros_like(r))


@functools.lru_cache(maxsize=16)
def _radial_run(t, h1, h0, radius, g, cells):
    """Return (centres, depth, velocity) at ``t``: HLL, minmod slopes of depth and velocity, Heun steps."""
    dr = radius / cells
    # nothing outruns 2 sqrt(g h1)
    n = math.ceil((radius + 2.05 * math.sqrt(g * h1) * t) / dr) + 4
    edge, centre = dr * np.arange(n + 1), dr * (np.arange(n) + 0.5)
    state = np.stack([np.where(centre < radius, h1, h0), np.zeros(n)])
    time = 0.0
    while time < t * (1 - 1e-12):
        u = _speed(state)
        dt = min(0.4 * dr / float((np.abs(u) + np.sqrt(g * state[0])).max()), t - time)
        first = state + dt * _rate(state, edge, centre, dr, g)
        state = 0.5 * (state + first + dt * _rate(first, edge, centre, dr, g))
        state[0] = np.maximum(state[0], 0.0)
        time += dt
    return centre, state[0], _speed(state)


def _speed(state):
    return np.where(state[0] > DRY, state[1] / np.maximum(state[0], DRY), 0.0)


def _rate(state, edge, centre, dr, g):
    # the axis is a mirror; so is the far end, which nothing reaches
    d, u = np.pad(np.maximum(state[0], 0.0), 2, "symmetric"), np.pad(_speed(state), 2, "symmetric")
    u[:2] *= -1
    u[-2:] *= -1
    sd, su = 0.5 * minmod(d), 0.5 * minmod(u)
    d, u = d[1:-1], u[1:-1]
    mass, momentum, _ = hll((d + sd)[:-1], (u + su)[:-1], (d - sd)[1:], (u - su)[1:], g)
    pressure = 0.5 * g * d[1:-1] ** 2
    return np.stack([-np.diff(edge * mass), pressure * dr - np.diff(edge * momentum)]) / (centre * dr)
