"""Where water stands at the start: its depth on fine cells, volumes of them, and random points in them."""

import numpy as np

from melt.errors import GeometryError, InputError

#: Edge of a cell in spacings, that where there would be more than so many cells, and the cells that fit at all.
FINE, COARSE, MANY, MOST_CELLS = 0.25, 0.5, 4_000_000, 40_000_000
#: Steps of the Hilbert curve along a cell, no simple fraction.
SKEW = 1.618
#: A cell half wet is cut into this many by as many.
CUT = 8


class Raster:
    """Volume of water in the cells of a box.

    Attributes:
        lower: (2,) [m].
        cell: (2,) edges [m]; they divide the box.
        volume: (ny, nx) [m^3]; midpoint rule, cells at the rim of the water cut into ``CUT``^2.
        wet: (ny, nx) area of the cell that is wet [m^2].
    """

    def __init__(self, depth, lower, upper, spacing):
        """Sample ``depth(x, y)`` [m] in the box.

        Raises:
            InputError: a box or spacing that is none; a depth that is not finite.
            GeometryError: too many cells, or no water in the box.
        """
        lower, upper = np.asarray(lower, float), np.asarray(upper, float)
        if not (np.isfinite([*lower, *upper, spacing]).all() and (upper > lower).all() and spacing > 0):
            raise InputError(f"box {lower} to {upper} m at spacing {spacing} m: upper above lower, spacing above 0")
        self.depth = depth
        lower, upper = self._wet_box(lower, upper, spacing)
        self.lower, self.upper = lower, upper
        edge = np.clip(np.sqrt(np.prod(upper - lower) / MANY) / spacing, FINE, COARSE)
        shape = np.maximum(np.ceil((upper - lower) / (edge * spacing) - 1e-9).astype(np.int64), 4)
        if shape.prod() > MOST_CELLS:
            raise GeometryError(
                f"water over {upper - lower} m at spacing {spacing:g} m needs {shape.prod():.3g} cells of start depth, "
                f"more than {MOST_CELLS:,}: raise the spacing or narrow the region"
            )
        self.cell = (upper - lower) / shape
        x, y = np.meshgrid(*(lower[k] + self.cell[k] * (np.arange(shape[k]) + 0.5) for k in (0, 1)))
        d = self.at(x, y)
        self.volume, self.wet = d * self.cell.prod(), np.where(d > 0, self.cell.prod(), 0.0)
        self._rim(d > 0, x, y)
        if not self.volume.sum() > 0:
            raise GeometryError(f"no water between {lower} and {upper} m: lower the bed, or give a depth above 0")

    def at(self, x, y):
        """Return the depth [m], never negative."""
        d = np.asarray(self.depth(x, y), float)
        if not np.isfinite(d).all():
            where = np.flatnonzero(~np.isfinite(np.broadcast_to(d, np.shape(x)).ravel()))[0]
            raise InputError(f"start depth at ({np.ravel(x)[where]:g}, {np.ravel(y)[where]:g}) m is not finite")
        return np.maximum(np.broadcast_to(d, np.shape(x)), 0.0)

    def _wet_box(self, lower, upper, spacing):
        """Return the box of what a look at every spacing finds wet, two spacings wider (narrower water may be missed)."""
        shape = np.ceil((upper - lower) / spacing).astype(np.int64)
        if shape.prod() > MOST_CELLS:
            raise GeometryError(f"a box of {upper - lower} m has {shape.prod():.3g} columns at spacing {spacing:g} m")
        step = (upper - lower) / shape
        x, y = np.meshgrid(*(lower[k] + step[k] * (np.arange(shape[k]) + 0.5) for k in (0, 1)))
        wet = self.at(x, y) > 0
        if not wet.any():
            return lower, upper
        found = [np.flatnonzero(wet.any(axis=k)) for k in (0, 1)]
        first = np.maximum([f[0] - 2 for f in found], 0)
        last = np.minimum([f[-1] + 3 for f in found], shape)
        return lower + first * step, np.where(last == shape, upper, lower + last * step)

    def _rim(self, wet, x, y):
        """Cut cells that have a neighbour of the other kind."""
        rim = np.zeros_like(wet)
        for axis in (0, 1):
            differs = np.diff(wet, axis=axis)
            rim[(slice(None),) * axis + (slice(1, None),)] |= differs
            rim[(slice(None),) * axis + (slice(-1),)] |= differs
        part = (np.arange(CUT) + 0.5) / CUT - 0.5
        px, py = (a.ravel()[:, None] for a in np.meshgrid(part, part))
        d = self.at(x[rim] + px * self.cell[0], y[rim] + py * self.cell[1])
        self.volume[rim] = d.mean(axis=0) * self.cell.prod()
        self.wet[rim] = (d > 0).mean(axis=0) * self.cell.prod()

    def fields(self, density):
        """Return ``density`` (ny, nx) of the cells by nearest cell of points (2, ...), 0 outside."""
        ny, nx = density.shape

        def look(x):
            i = np.floor((x[0] - self.lower[0]) / self.cell[0]).astype(np.int64)
            j = np.floor((x[1] - self.lower[1]) / self.cell[1]).astype(np.int64)
            inside = (i >= 0) & (i < nx) & (j >= 0) & (j < ny)
            return np.where(inside, density[np.clip(j, 0, ny - 1), np.clip(i, 0, nx - 1)], 0.0)

        return look

    def draw(self, share, count, random):
        """Return ``count`` points (2, count) in wet places, as dense as ``share`` (ny, nx) of the cells.

        Point k stands where the k-th equal part of the sum has its middle along a Hilbert curve: neighbours on
        the curve are neighbours in the plane, so that every patch gets its number to about one. The curve is
        askew to the cells: along them its squares would hold one point each and start a lattice.
        """
        j, i = np.nonzero(share > 0)
        a, b = SKEW * (i - 0.37 * j), SKEW * (j + 0.37 * i)
        order = np.argsort(hilbert(np.floor(a - a.min()), np.floor(b - b.min())), kind="stable")
        i, j = i[order], j[order]
        total = np.cumsum(share[j, i])
        pick = np.searchsorted(total, total[-1] * (np.arange(count) + 0.5) / count)
        corner = self.lower[:, None] + self.cell[:, None] * np.stack([i, j])[:, np.minimum(pick, i.size - 1)]
        x = corner + self.cell[:, None] * random.uniform(size=(2, count))
        for _ in range(64):  # a cell of the rim has dry parts
            dry = np.flatnonzero(self.at(*x) <= 0)
            if dry.size == 0:
                return x
            x[:, dry] = corner[:, dry] + self.cell[:, None] * random.uniform(size=(2, dry.size))
        return x[:, self.at(*x) > 0]


def hilbert(i, j):
    """Return the place of the cells (i, j), along a Hilbert curve."""
    i, j, key = np.array(i, np.int64), np.array(j, np.int64), np.zeros(np.shape(i), np.int64)
    for level in range(int(max(i.max(), j.max())).bit_length() - 1, -1, -1):
        side = 1 << level
        a, b = (i & side) > 0, (j & side) > 0
        key += (3 * a ^ b) * side * side
        i, j = i & (side - 1), j & (side - 1)
        turn = ~b
        i, j = np.where(turn & a, side - 1 - i, i), np.where(turn & a, side - 1 - j, j)
        i, j = np.where(turn, j, i), np.where(turn, i, j)
    return key
