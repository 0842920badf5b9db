"""Regions of the plane that columns enter in: each maps pairs of uniform numbers to uniform places."""

import numpy as np

from melt.errors import GeometryError


class Disc:
    """A disc of a radius [m] around a centre."""

    def __init__(self, centre, radius):
        self.centre, self.radius = np.array(centre, dtype=np.float64), float(radius)
        if not self.radius > 0:
            raise GeometryError(f"a disc of radius {radius:g} m has no inside: give a positive radius")

    def points(self, uniform):
        """Return places (..., 2) of uniform numbers (..., 2)."""
        r, turn = self.radius * np.sqrt(uniform[..., 0]), 2 * np.pi * uniform[..., 1]
        return self.centre + np.stack([r * np.cos(turn), r * np.sin(turn)], axis=-1)


class Box:
    """A rectangle along the axes."""

    def __init__(self, lower, upper):
        self.lower, self.upper = np.array(lower, dtype=np.float64), np.array(upper, dtype=np.float64)
        if not (self.upper > self.lower).all():
            raise GeometryError(f"a box from {tuple(lower)} to {tuple(upper)} has no inside: give its lower corner first")

    def points(self, uniform):
        """Return places (..., 2) of uniform numbers (..., 2)."""
        return self.lower + uniform * (self.upper - self.lower)


class Line:
    """A chain of straight pieces; places are uniform along it."""

    def __init__(self, corners):
        self.corners = np.array(corners, dtype=np.float64)
        length = np.hypot(*np.diff(self.corners, axis=0).T) if len(self.corners) > 1 else np.zeros(1)
        self._along = np.concatenate([[0.0], np.cumsum(length)])
        if not self._along[-1] > 0:
            raise GeometryError("a line needs two different points")

    def points(self, uniform):
        """Return places (..., 2) of uniform numbers (..., 2), of which the second is not used."""
        s = uniform[..., 0] * self._along[-1]
        return np.stack([np.interp(s, self._along, x) for x in self.corners.T], axis=-1)


class Polygon:
    """A polygon whose edges do not cross; cut into trapezoids between the heights of its corners."""

    def __init__(self, corners):
        x = np.array(corners, dtype=np.float64)
        if len(x) < 3 or _crosses(x):
            raise GeometryError("a polygon needs three corners or more, and edges that do not cross: give its corners in order")
        heights = np.unique(x[:, 1])
        ends, start = np.roll(x, -1, axis=0), x
        pieces = []
        for low, high in zip(heights, heights[1:]):
            middle = 0.5 * (low + high)
            cut = (np.minimum(start[:, 1], ends[:, 1]) < middle) & (np.maximum(start[:, 1], ends[:, 1]) > middle)
            a, b = start[cut], ends[cut]
            slope = (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
            at = [a[:, 0] + slope * (y - a[:, 1]) for y in (low, middle, high)]
            order = np.argsort(at[1])
            for left, right in zip(order[::2], order[1::2]):
                pieces.append((low, high, at[0][left], at[0][right], at[2][left], at[2][right]))
        self._piece = np.array(pieces).reshape(-1, 6)
        low, high, a, b, c, d = self._piece.T
        self.area = float((areas := 0.5 * (high - low) * ((b - a) + (d - c))).sum())
        if not self.area > 0:
            raise GeometryError("a polygon without an area: its corners lie on a line")
        self._share = np.cumsum(areas) / self.area

    def points(self, uniform):
        """Return places (..., 2) of uniform numbers (..., 2)."""
        u = uniform[..., 0]
        k = np.minimum(np.searchsorted(self._share, u, side="right"), len(self._share) - 1)
        before = np.concatenate([[0.0], self._share[:-1]])[k]
        share = np.clip((u - before) / (self._share[k] - before), 0, 1)
        low, high, a, b, c, d = np.moveaxis(self._piece[k], -1, 0)
        p, q = b - a, d - c  # widths at the bottom and at the top
        # share of the area below t: (p t + (q - p) t^2/2) / ((p + q)/2)
        t = share * (p + q) / (p + np.sqrt(p * p + (q - p) * (p + q) * share))
        left, right = a + t * (c - a), b + t * (d - b)
        return np.stack([left + uniform[..., 1] * (right - left), low + t * (high - low)], axis=-1)


def _crosses(x):
    """Return whether two edges of a polygon cross."""

    def turn(a, b, c):
        return np.sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    n = len(x)
    for i in range(n):
        for j in range(i + 2, n - (i == 0)):
            a, b, c, d = x[i], x[(i + 1) % n], x[j], x[(j + 1) % n]
            if turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0:
                return True
    return False
