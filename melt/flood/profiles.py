"""Water of a named shape at the start: depth and velocity as functions of place. Flood spec 6.

Each profile takes world coordinates x, y (arrays) [m], the bed elevation b there [m] and its parameters, and returns
(depth [m], u [m/s], v [m/s]). Elevations are the world's.
"""

import numpy as np


def thacker_planar(x, y, b, g, a=1.0, h0=0.1, eta=0.5, centre=(0.0, 0.0), time=0.0):
    """Planar surface in a paraboloid b = -h0 (1 - r^2/a^2): it revolves as a plane."""
    omega = np.sqrt(2 * g * h0) / a
    c, s = np.cos(omega * time), np.sin(omega * time)
    surface = h0 * eta / a**2 * (2 * (x - centre[0]) * c + 2 * (y - centre[1]) * s - eta)
    return np.maximum(surface - b, 0.0), np.full_like(x, -eta * omega * s), np.full_like(x, eta * omega * c)


def thacker_radial(x, y, b, g, a=1.0, h0=0.1, shoreline=0.8, centre=(0.0, 0.0), time=0.0):
    """Axisymmetric surface in the same paraboloid, at rest at first: it swells and sinks."""
    X, Y, omega = x - centre[0], y - centre[1], np.sqrt(8 * g * h0) / a
    A = (a**4 - shoreline**4) / (a**4 + shoreline**4)
    even = 1 - A * np.cos(omega * time)
    surface = h0 * (np.sqrt(1 - A**2) / even - 1 - (X**2 + Y**2) / a**2 * ((1 - A**2) / even**2 - 1))
    rate = 0.5 * omega * A * np.sin(omega * time) / even
    return np.maximum(surface - b, 0.0), rate * X, rate * Y


def thacker_channel(x, y, b, g, a=1.0, h0=0.5, amplitude=0.5, centre=(0.0, 0.0), time=0.0):
    """Planar surface in a parabolic channel b = h0 (X^2/a^2 - 1), tilted and at rest at first: it swings."""
    omega = np.sqrt(2 * g * h0) / a
    X = amplitude * np.cos(omega * time)
    surface = h0 / a**2 * (2 * (x - centre[0]) * X - X**2)
    return np.maximum(surface - b, 0.0), np.full_like(x, -amplitude * omega * np.sin(omega * time)), np.zeros_like(x)


def solitary(x, y, b, g, height=0.1, depth=1.0, crest=0.0, level=0.0, direction=1.0):
    """Solitary wave eta = H sech^2(sqrt(3 H/(4 d^3)) (x - x1)) on still water, moving along x."""
    eta = height / np.cosh(np.sqrt(3 * height / (4 * depth**3)) * (x - crest)) ** 2
    d = np.maximum(level + eta - b, 0.0)
    c = np.sqrt(g * (depth + height))
    return d, np.where(d > 0, direction * c * eta / (depth + eta), 0.0), np.zeros_like(x)


def channel(x, y, b, g, discharge=1.0, stage=None, depth=None):
    """Water that flows along x with a discharge per width q [m^2/s]: of one depth, or of one stage."""
    d = np.full_like(x, depth) if depth is not None else np.maximum(stage - b, 0.0)
    return d, np.where(d > 0, discharge / np.maximum(d, 1e-9), 0.0), np.zeros_like(x)


PROFILES = {
    "thacker_planar": thacker_planar,
    "thacker_radial": thacker_radial,
    "thacker_channel": thacker_channel,
    "solitary": solitary,
    "channel": channel,
}
