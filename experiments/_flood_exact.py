"""Exact solutions of the shallow-water equations: dam breaks, oscillating bowls, water at rest, the solitary wave.

Each function is vectorised over place and time (broadcast) and returns a `Flow`. g = 9.81 m/s^2 unless given.
"""

import math

import numpy as np

from melt.flood.dam_breaks import Flow, G, bore, ritter, stoker  # noqa: F401  (solutions of this page too)


def bowl_period(h0, a, g=G, radial=False):
    """Return the period [s] of the bowl b = -h0 (1 - r^2/a^2): 2 pi a/sqrt(2 g h0), half of it for the radial mode."""
    return 2 * math.pi * a / math.sqrt((8 if radial else 2) * g * h0)


def bowl(r2, h0, a):
    """Return b = -h0 (1 - r^2/a^2) [m] where r^2 = ``r2`` [m^2]."""
    return -h0 * (1 - np.asarray(r2, float) / a**2)


def thacker_1d(x, t, h0=0.5, a=1.0, amplitude=0.5, g=G):
    """Return the plane surface in a parabolic channel.

    The water moves as a whole: d = h0 (1 - (x - X)^2/a^2), u = dX/dt, X = amplitude cos(omega t), omega = sqrt(2 g h0)/a.
    SWASHES starts on the other side: ``amplitude`` < 0.
    """
    x, omega = np.asarray(x, float), math.sqrt(2 * g * h0) / a
    d = np.maximum(0.0, h0 * (1 - ((x - amplitude * np.cos(omega * t)) / a) ** 2))
    return Flow(d, np.where(d > 0, -amplitude * omega * np.sin(omega * t), 0.0), bowl(x**2, h0, a) + 0 * d)


def thacker_planar(x, y, t, h0=0.1, a=1.0, amplitude=0.5, g=G):
    """Return the plane surface that circles in a paraboloid.

    d = h0 (1 - |x - X|^2/a^2), X = amplitude (cos omega t, sin omega t), v = dX/dt; the same as Thacker's
    h0 amplitude/a^2 (2x cos + 2y sin - amplitude) - b.
    """
    x, y, omega = np.asarray(x, float), np.asarray(y, float), math.sqrt(2 * g * h0) / a
    cos, sin = amplitude * np.cos(omega * t), amplitude * np.sin(omega * t)
    d = np.maximum(0.0, h0 * (1 - ((x - cos) ** 2 + (y - sin) ** 2) / a**2))
    v = np.where((d > 0)[..., None], omega * np.stack(np.broadcast_arrays(-sin + 0 * d, cos + 0 * d), -1), 0.0)
    return Flow(d, v, bowl(x**2 + y**2, h0, a) + 0 * d)


def thacker_radial(x, y, t, h0=0.1, a=1.0, shoreline=0.8, g=G):
    """Return the curved surface that pulsates in a paraboloid; ``shoreline`` is its radius R [m] at t = 0.

    d = h0 (s - (r/a)^2 s^2), s = sqrt(1 - A^2)/(1 - A cos omega t), v = omega r A sin omega t/(2 (1 - A cos omega t)),
    omega = sqrt(8 g h0)/a, A = (a^4 - R^4)/(a^4 + R^4). SWASHES names r0 with A = (a^2 - r0^2)/(a^2 + r0^2): R = sqrt(a r0).
    The volume is pi h0 a^2/2 at any time and for any R.
    """
    x, y, omega = np.asarray(x, float), np.asarray(y, float), math.sqrt(8 * g * h0) / a
    A = (a**4 - shoreline**4) / (a**4 + shoreline**4)
    slow = 1 - A * np.cos(omega * t)
    s = math.sqrt(1 - A**2) / slow
    d = np.maximum(0.0, h0 * s * (1 - (x**2 + y**2) / a**2 * s))
    rate = 0.5 * omega * A * np.sin(omega * t) / slow
    v = np.where((d > 0)[..., None], np.stack(np.broadcast_arrays(rate * x + 0 * d, rate * y + 0 * d), -1), 0.0)
    return Flow(d, v, bowl(x**2 + y**2, h0, a) + 0 * d)


def bump(x, smooth=False):
    """Return the bed [m] of a bump 0.2 m high at 8 < x < 12 m.

    Kinked: 0.2 - 0.05 (x - 10)^2; ``smooth``: 0.1 (1 + cos(pi (x - 10)/2)), whose slope is continuous.
    """
    away = np.asarray(x, float) - 10
    return np.where(np.abs(away) < 2, 0.1 * (1 + np.cos(0.5 * np.pi * away)) if smooth else 0.2 - 0.05 * away**2, 0.0)


def lake(bed, stage):
    """Return water at rest up to ``stage`` [m] over ``bed`` [m] (one dimension; velocities are zero in two as well)."""
    bed = np.asarray(bed, float)
    return Flow(np.maximum(0.0, stage - bed), np.zeros_like(bed), bed)


def solitary(x, H, still, crest=0.0, t=0.0, g=G):
    """Return the solitary wave of height ``H`` [m] on a depth ``still`` [m], crest at ``crest`` + c t.

    eta = H sech^2(sqrt(3H/(4 still^3)) (x - crest - c t)), c = sqrt(g (still + H)), u = c eta/(still + eta). The bed lies at -still,
    so that depth + bed = eta. Exact for Serre's equations; in the shallow-water equations it is a start, and steepens.
    """
    c = math.sqrt(g * (still + H))
    eta = H / np.cosh(np.minimum(np.sqrt(0.75 * H / still**3) * np.abs(np.asarray(x, float) - crest - c * t), 300.0)) ** 2
    return Flow(still + eta, c * eta / (still + eta), np.full_like(eta, -still))


def solitary_start(H, still, toe):
    """Return where Synolakis' wave starts: half a wave length L = 2/k arcosh(sqrt 20), k = sqrt(3H/(4 still^3)), before the ``toe`` [m]."""
    return toe + math.acosh(math.sqrt(20)) / math.sqrt(0.75 * H / still**3)


def plane_beach_runup(H_over_d, cotangent=19.85):
    """Return R/d of a solitary wave: 2.831 sqrt(cot) (H/d)^1.25 unbroken, 1.109 (H/d)^0.582 broken.

    It breaks in running up beyond H/d = 0.8183 cot^(-10/9), 0.030 on Synolakis' beach (1987), which the second law was fitted to. Kept
    up to H/d = 0.045, as is also done, the first law lies 40 % above his measurements.
    """
    H = np.asarray(H_over_d, float)
    return np.where(H > 0.8183 * cotangent ** (-10 / 9), 1.109 * H**0.582, 2.831 * math.sqrt(cotangent) * H**1.25)
