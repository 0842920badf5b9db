"""Water of a scene's `melt.scene.flood_bodies.Pool` as functions of the plane, for `melt.geometry.columns.place`."""

from types import SimpleNamespace

import numpy as np

from melt.geometry.outlines import inside


def region_of(pool):
    """Return the function of x and y [m] (arrays of one shape) that is true in the pool's region."""
    if pool.lower is not None:
        (x0, y0), (x1, y1) = pool.lower, pool.upper
        return lambda x, y: (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)
    if pool.centre is not None:
        return lambda x, y: np.hypot(x - pool.centre[0], y - pool.centre[1]) <= pool.radius
    if pool.polygon is not None:
        outline = SimpleNamespace(shape="polygon", polygon=pool.polygon, hole=None)
        return lambda x, y: inside(outline, np.stack([np.ravel(x), np.ravel(y)])).reshape(np.shape(x))
    return lambda x, y: np.ones(np.shape(x), bool)


def without(outlines, region=None):
    """Return a region without the obstacles in it: water does not start inside of them."""

    def free(x, y):
        points = np.stack([np.ravel(x), np.ravel(y)])
        solid = np.zeros(points.shape[1], bool)
        for outline in outlines:
            solid |= inside(outline, points)
        open_ = ~solid.reshape(np.shape(x))
        return open_ if region is None else open_ & region(x, y)

    return free
