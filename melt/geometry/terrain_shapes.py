"""Analytic beds: elevation [m] as a function of x and y [m], for tests with known solutions. Flood spec 6.

A shape takes ``x`` (1, nx) and ``y`` (ny, 1) and its own parameters, all with defaults; what it returns
broadcasts to (ny, nx). Noise is a function of place and seed alone: a finer grid samples the same ground.
"""

import difflib
import inspect

import numpy as np

from melt.units import read

_ABOVE_ZERO = {
    "radius", "width", "curvature", "wavelength", "base_diameter", "discharge", "manning", "octaves",
}  # fmt: skip


def flat(x, y, height=0.0):
    """A level bed."""
    return np.full(np.broadcast_shapes(x.shape, y.shape), float(height))


def plane(x, y, slope=0.01, direction=0.0, height=0.0):
    """An inclined plane of elevation ``height`` at (0, 0) that falls along ``direction`` [deg from x]."""
    return height - slope * _along(x, y, direction)


def bowl(x, y, depth=0.1, radius=1.0, centre=(0.0, 0.0), dimension=2):
    """Thacker's parabola -depth (1 - r^2 / radius^2); with ``dimension = 1`` r = x - centre x."""
    return -depth * (1 - _square(x, y, centre, dimension) / radius**2)


def bump(x, y, height=0.2, curvature=0.05, centre=(10.0, 0.0), dimension=1):
    """The bump of the steady flows, max(0, height - curvature r^2): its foot is a kink."""
    return np.maximum(0.0, height - curvature * _square(x, y, centre, dimension))


def smooth_bump(x, y, height=0.2, width=2.0, centre=(10.0, 0.0), dimension=1):
    """A cosine bump of half width ``width``, smooth at its foot."""
    r = np.sqrt(_square(x, y, centre, dimension))
    return 0.5 * height * (1 + np.cos(np.pi * np.minimum(r / width, 1.0)))


def step(x, y, position=0.0, height=1.0, direction=0.0, run=0.0):
    """A rise by ``height`` (a fall if negative) at ``position`` along ``direction``, over ``run`` metres."""
    s = _along(x, y, direction) - position
    return height * (np.clip(s / run, 0.0, 1.0) if run > 0 else (s >= 0).astype(float))


def cliff(x, y, position=0.0, height=10.0, direction=0.0, run=0.0):
    """A plateau of ``height`` that falls to 0 at ``position`` along ``direction``, over ``run`` metres."""
    return height - step(x, y, position, height, direction, run)


def sill(x, y, toe=25.5, crest=28.5, end=31.5, height=0.4):
    """A triangular sill across x (CADAM's unless given otherwise)."""
    if not toe < crest < end:
        raise ValueError(f"a sill needs toe < crest < end, given are {toe:g}, {crest:g}, {end:g}")
    return np.interp(x, [toe, crest, end], [0.0, height, 0.0]) + 0.0 * y


def beach(x, y, slope=1 / 19.85, depth=1.0, shore=0.0):
    """A beach whose still water line is x = ``shore``, with the sea at x > shore down to -``depth``."""
    return np.maximum(-slope * (x - shore), -depth) + 0.0 * y


def cone(x, y, centre=(12.96, 13.8), base_diameter=7.2, crest_diameter=None, height=0.625, slope=None):
    """A frustum (the conical island of Briggs et al.); ``slope`` may stand in for ``crest_diameter``."""
    if slope is not None and crest_diameter is not None:
        raise ValueError("a cone takes either slope or crest_diameter, the other follows from height")
    crest = 2.2 if crest_diameter is None else crest_diameter
    if slope is None:
        if not crest < base_diameter:
            raise ValueError(f"crest_diameter = {crest:g} must be less than base_diameter = {base_diameter:g}")
        slope = 2 * height / (base_diameter - crest)
    r = np.sqrt(_square(x, y, centre, 2))
    return np.clip(slope * (0.5 * base_diameter - r), 0.0, height)


def pit(x, y, depth=2.0, radius=5.0, centre=(0.0, 0.0)):
    """A plain at 0 with a closed basin, cosine in section."""
    return -smooth_bump(x, y, depth, radius, centre, 2)


def slope_then_plain(x, y, slope=0.1, toe=0.0):
    """A slope that falls along x to the plain 0 at x = ``toe``."""
    return np.maximum(0.0, slope * (toe - x)) + 0.0 * y


def macdonald_depth(x, gravity=9.81):
    """Return (depth, its derivative) at x in 0 .. 100 m of MacDonald's short channel. Flood spec 6."""
    scale, r = (4 / gravity) ** (1 / 3), np.asarray(x, float) / 100 - 2 / 3
    a1, a2, a3, a4 = 0.674202, 21.7112, 14.492, 1.4305
    before = scale * (2 / 3 - r) - 0.9 * (r + 2 / 3) * r
    behind = scale * (((a1 * r + a1) * r - a2) * r * r + a3 * r + a4)
    slope_before = -scale - 1.8 * r - 0.6
    slope_behind = scale * ((4 * a1 * r + 3 * a1) * r * r - 2 * a2 * r + a3)
    upstream = r < 0
    return np.where(upstream, before, behind), np.where(upstream, slope_before, slope_behind) / 100


def macdonald(x, y, discharge=2.0, manning=0.0328, gravity=9.81):
    """MacDonald's short channel with a jump at x = 200/3 m; level beyond its ends x = 0 and 100 m.

    b_x = (q^2 / (g d^3) - 1) d_x - n^2 q^2 / d^(10/3) with b(100) = 0. The first term is the derivative of
    -q^2 / (2 g d^2) - d, so only friction is integrated, by Gauss points, on each side of the jump.
    """
    where = np.clip(np.ravel(x).astype(float), 0.0, 100.0)
    jump, points = 200 / 3, np.polynomial.legendre.leggauss(64)

    def head(d):
        return -(discharge**2) / (2 * gravity * d**2) - d

    def fall(start, end):
        """Return b(start) - b(end) within one side; the limit at the jump is taken from that side."""
        mid, half = 0.5 * (start + end), 0.5 * (end - start)
        s = mid[:, None] + half[:, None] * points[0]
        d = macdonald_depth(s, gravity)[0]
        friction = half * (points[1] * (manning * discharge) ** 2 / d ** (10 / 3)).sum(axis=1)
        inside = 1e-9 * half
        ends = [macdonald_depth(p, gravity)[0] for p in (start + inside, end - inside)]
        return head(ends[0]) - head(ends[1]) + friction

    behind = fall(np.maximum(where, jump), np.full_like(where, 100.0))
    before = fall(np.minimum(where, jump), np.full_like(where, jump))
    return (behind + before)[None, :] + 0.0 * y


def noise(x, y, amplitude=1.0, wavelength=20.0, octaves=4, roughness=0.5, seed=0):
    """Random hills within +- ``amplitude``; ``roughness`` is the ratio of one octave's height to the next."""
    octaves = int(octaves)
    weights = float(roughness) ** np.arange(octaves)
    total = 0.0
    for k, weight in enumerate(weights / weights.sum()):
        total = total + weight * _value_noise(x, y, wavelength / 2**k, int(seed) + 101 * k)
    return amplitude * total


def valley(x, y, relief=100.0, width=400.0, slope=0.005, wavelength=600.0, octaves=5, seed=1):
    """A winding valley that falls along x between ridges of noise that grow with the distance from it.

    ``width``: half width over which the flanks rise. The valley's line is y = 0 on average.
    """
    line = 0.5 * width * _value_noise(x, np.zeros((1, 1)), 3 * wavelength, int(seed) + 7)
    flank = np.abs(y - line) / width
    rise = flank**2 / (1 + flank**2)  # from 0 with no slope in the bed to 1 far out
    ridges, weight, total = 0.0, 1.0, 0.0
    for k in range(int(octaves)):
        bare = _value_noise(x, y, wavelength / 2**k, int(seed) + 101 * k)
        # squared, a ridge keeps its crest and loses its kink in the valleys
        ridges, total = ridges + weight * (1 - np.abs(bare)) ** 2, total + weight
        weight *= 0.45
    return relief * rise * (0.4 + 0.6 * ridges / total) - slope * x


def _along(x, y, degrees):
    angle = np.radians(degrees)
    # exact zeros for the axes, so that a bed along x does not depend on y
    c, s = (0.0 if abs(v) < 1e-15 else v for v in (np.cos(angle), np.sin(angle)))
    return c * x + s * y


def _square(x, y, centre, dimension):
    if dimension not in (1, 2):
        raise ValueError(f"dimension = {dimension:g} must be 1 (a shape along x) or 2 (a round one)")
    return (x - centre[0]) ** 2 + (0.0 * y if dimension == 1 else (y - centre[1]) ** 2)


def _value_noise(x, y, wavelength, seed):
    """Return noise in -1 .. 1: hashed values at a lattice, quintic between (twice differentiable).

    ``x`` (1, nx) and ``y`` (ny, 1): the lattice is hashed once, not once for each of the nodes between.
    """
    x, y = np.asarray(x) / wavelength, np.asarray(y) / wavelength
    (i, u), (j, v) = ((np.floor(t).astype(np.int64), t - np.floor(t)) for t in (x, y))
    u, v = (t * t * t * (t * (6 * t - 15) + 10) for t in (u, v))
    columns, rows = (np.unique([k, k + 1]) for k in (i, j))
    lattice = _hash(columns[None, :], rows[:, None], seed)
    i, j = np.searchsorted(columns, i), np.searchsorted(rows, j)
    i1, j1 = np.minimum(i + 1, len(columns) - 1), np.minimum(j + 1, len(rows) - 1)
    low = (1 - u) * lattice[j, i] + u * lattice[j, i1]
    high = (1 - u) * lattice[j1, i] + u * lattice[j1, i1]
    return (1 - v) * low + v * high


def _hash(i, j, seed):
    """Return a number in -1 .. 1 of a lattice point (splitmix64): the same on every machine."""
    z = i.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15) ^ j.astype(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F)
    z = z + np.uint64((seed * 0xD6E8FEB86659FD93) & 0xFFFFFFFFFFFFFFFF)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        z = (z ^ (z >> np.uint64(shift))) * np.uint64(factor)
    z = z ^ (z >> np.uint64(31))
    return (z >> np.uint64(11)).astype(np.float64) * 2.0**-52 - 1.0


SHAPES = {
    f.__name__: f
    for f in (
        flat, plane, bowl, bump, smooth_bump, step, cliff, sill, beach, cone, pit, slope_then_plain, macdonald,
        noise, valley,
    )
}  # fmt: skip


def parameters(name):
    """Return {parameter: default} of a shape."""
    known = list(inspect.signature(SHAPES[name]).parameters.values())[2:]
    return {p.name: p.default for p in known}


def check(name, given):
    """Return the parameters of a shape as numbers, in metres.

    Raises:
        ValueError: an unknown parameter, a value of the wrong kind, or values that make no shape.
    """
    known, clean = parameters(name), {}
    for key, value in given.items():
        if key not in known:
            close = difflib.get_close_matches(key, known, 1)
            hint = f"did you mean {close[0]!r}?" if close else f"it takes {', '.join(known)}"
            raise ValueError(f"the shape {name!r} has no parameter {key!r}; {hint}")
        pair = isinstance(known[key], tuple)
        if pair != isinstance(value, list | tuple) or (pair and len(value) != 2):
            raise ValueError(f"{key} = {value!r} must be {'a pair [x, y]' if pair else 'one number'}")
        numbers = [read(v, "length") for v in (value if pair else [value])]
        if not np.isfinite(numbers).all():
            raise ValueError(f"{key} = {value!r} is not finite")
        if key in _ABOVE_ZERO and not numbers[0] > 0:
            raise ValueError(f"{key} = {value!r} must be greater than 0")
        clean[key] = numbers if pair else numbers[0]
    SHAPES[name](np.zeros((1, 1)), np.zeros((1, 1)), **clean)  # what the values together forbid
    return clean


def sample(name, x, y, given):
    """Return the elevation (ny, nx) of a shape at nodes ``x`` (nx,) and ``y`` (ny,)."""
    x, y = np.asarray(x, float)[None, :], np.asarray(y, float)[:, None]
    bed = np.empty((y.shape[0], x.shape[1]))
    for start in range(0, len(bed), 512):  # blocks of rows: noise needs several times the room of its result
        rows = slice(start, start + 512)
        bed[rows] = SHAPES[name](x, y[rows], **given)
    return bed
