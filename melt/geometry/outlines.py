"""Outlines in the plane: what is inside of boxes, circles and polygons, and how far from their edge.

An outline is an object with ``shape`` ("box", "cylinder" or "polygon") and what that shape needs: ``centre`` (2,),
``size`` (2,), ``radius`` [m], ``angle`` [deg, anticlockwise about the centre], ``polygon`` (k, 2), ``hole`` (k, 2)
or None: the outlines of `melt.scene.flood_bodies`.
"""

import numpy as np

from melt.errors import GeometryError


def frame(outline, x):
    """Return points (2, n) in the frame of a box: from its centre, along its edges."""
    turn = np.deg2rad(outline.angle or 0.0)
    c, s = np.cos(turn), np.sin(turn)
    away = x - np.asarray(outline.centre, float)[:, None]
    return np.stack([c * away[0] + s * away[1], c * away[1] - s * away[0]])


def unframe(outline, y):
    """Return the points whose `frame` is y (2, n)."""
    turn = np.deg2rad(outline.angle or 0.0)
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(outline.centre, float)[:, None] + np.stack([c * y[0] - s * y[1], s * y[0] + c * y[1]])


def rings(outline):
    """Return the closed rings [(2, k), ...] of a polygon: its outside, then its hole.

    Raises:
        GeometryError: fewer than three corners, or no area.
    """
    found = [np.asarray(outline.polygon, float).T]
    if getattr(outline, "hole", None) is not None:
        found.append(np.asarray(outline.hole, float).T)
    for ring in found:
        if ring.shape[1] < 3 or not abs(_area(ring)) > 0:
            raise GeometryError(f"polygon {ring.T.tolist()}: at least three corners that are not in one line")
    return found


def _area(ring):
    a, b = ring, np.roll(ring, -1, axis=1)
    return 0.5 * np.sum(a[0] * b[1] - a[1] * b[0])


def area(outline):
    """Return the area inside [m^2]."""
    if outline.shape == "box":
        return float(np.prod(outline.size))
    if outline.shape == "cylinder":
        return float(np.pi * outline.radius**2)
    outside, *holes = (abs(_area(ring)) for ring in rings(outline))
    return float(outside - sum(holes))


def corners(outline):
    """Return the bounding box: lower and upper corner (2,) [m]."""
    if outline.shape == "polygon":
        ring = rings(outline)[0]
        return ring.min(axis=1), ring.max(axis=1)
    if outline.shape == "cylinder":
        return np.asarray(outline.centre) - outline.radius, np.asarray(outline.centre) + outline.radius
    half = 0.5 * np.asarray(outline.size, float)[:, None]
    edge = unframe(outline, half * np.array([[-1, 1, 1, -1], [-1, -1, 1, 1]]))
    return edge.min(axis=1), edge.max(axis=1)


def distance(outline, x):
    """Return the signed distance (n,) [m] of points (2, n) to the edge: above 0 outside, below inside."""
    x = np.asarray(x, float)
    if outline.shape == "cylinder":
        return np.hypot(*(x - np.asarray(outline.centre, float)[:, None])) - outline.radius
    if outline.shape == "box":
        beyond = np.abs(frame(outline, x)) - 0.5 * np.asarray(outline.size, float)[:, None]
        return np.hypot(*np.maximum(beyond, 0.0)) + np.minimum(beyond.max(axis=0), 0.0)
    nearest, odd = np.full(x.shape[1], np.inf), np.zeros(x.shape[1], bool)
    for ring in rings(outline):
        for a, b in zip(ring.T, np.roll(ring, -1, axis=1).T):
            nearest = np.minimum(nearest, _to_segment(x, a, b))
            odd ^= _crosses(x, a, b)
    return np.where(odd, -nearest, nearest)


def inside(outline, x):
    """Return which of the points (2, n) are inside, edge included."""
    if outline.shape != "polygon":
        return distance(outline, x) <= 0
    odd = np.zeros(x.shape[1], bool)
    for ring in rings(outline):
        for a, b in zip(ring.T, np.roll(ring, -1, axis=1).T):
            odd ^= _crosses(x, a, b)
    return odd


def _to_segment(x, a, b):
    along, away = b - a, x - a[:, None]
    t = np.clip(along @ away / max(along @ along, 1e-300), 0.0, 1.0)
    return np.hypot(*(away - along[:, None] * t))


def _crosses(x, a, b):
    """Whether a ray from the points towards x+ crosses the edge from a to b (half open: a corner counts once)."""
    straddles = (a[1] > x[1]) != (b[1] > x[1])
    rise = b[1] - a[1] if b[1] != a[1] else 1.0
    return straddles & (x[0] < a[0] + (x[1] - a[1]) * (b[0] - a[0]) / rise)


def signed_distance(outlines, nodes):
    """Return the signed distance (n,) [m] of points (2, n) to the union of outlines; inf where there are none.

    Outside it is exact. Inside of several at once it is that to the edge that is farthest in, no more than the true one.
    """
    nodes = np.asarray(nodes, float)
    found = np.full(nodes.shape[1], np.inf)
    for outline in outlines:
        lower, upper = corners(outline)
        beyond = np.maximum(np.maximum(lower[:, None] - nodes, nodes - upper[:, None]), 0.0)
        close = np.hypot(*beyond) < np.maximum(found, 1e-300)  # elsewhere an earlier outline is nearer than this one's box
        found[close] = np.minimum(found[close], distance(outline, nodes[:, close]))
    return found
