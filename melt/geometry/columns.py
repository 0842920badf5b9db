"""Where water columns stand at the start: places and volumes that hold a given depth.

A lattice that stretches along one axis decouples into rows (2-D Ritter dam break: 3.0 % error on an aligned lattice,
0.9 % on a jittered one). Columns are therefore drawn evenly, moved at random, and then shifted until their number
density is that of the water; lattices are there for comparison.
"""

import numpy as np

from melt.errors import InputError
from melt.geometry.raster import Raster
from melt.geometry.relaxation import relax_columns
from melt.geometry.shapes import affordable

LAYOUTS = ("equal_mass", "equal_area", "lattice", "hexagonal")
#: Columns that stand for an area are not placed where water is thinner than this share of the reference depth.
THIN = 1e-3


def place(
    depth, lower, upper, spacing, *, layout="equal_mass", reference_depth=None, seed=0, jitter=0.4, relax=30,
    region=None,
):
    """Return places x (2, n) [m] and volumes (n,) [m^3] of columns that hold the water of a region.

    Args:
        depth: of the water, a function of coordinates x and y [m] (arrays of one shape); dry where it is not above 0.
        lower, upper: corners (2,) of the box to fill [m].
        spacing: r0 [m].
        layout: "equal_mass" (each column has r0^2 times the reference depth, so that they crowd in deep water),
            "equal_area" (each stands for r0^2; volume by its depth), and the same area on a square "lattice" or a
            "hexagonal" one, neither moved nor relaxed: for comparison.
        reference_depth: d of equal mass [m]; the mean depth unless given.
        seed: of what is drawn at random; equal arguments give equal results.
        jitter: largest random move along each axis in spacings, before relaxation.
        relax: sweeps of `melt.geometry.relaxation.relax_columns`.
        region: function of x and y, true where water may stand (in addition to ``lower``, ``upper``).

    The volumes sum to that of the region (cells of a quarter spacing, cut finer at the rim) to rounding.

    Raises:
        InputError: an unknown layout, a box, spacing or depth that is none.
        GeometryError: no water in the region, or too many columns.
    """
    if layout not in LAYOUTS:
        raise InputError(f"layout = {layout!r}: one of {', '.join(LAYOUTS)}")
    if jitter < 0 or relax < 0 or not (reference_depth is None or reference_depth > 0):
        raise InputError(f"jitter {jitter} and relax {relax} must be at least 0, reference_depth {reference_depth} above 0")

    def water(x, y):
        d = np.broadcast_to(np.asarray(depth(x, y), float), np.shape(x))
        return d if region is None else np.where(region(x, y), d, 0.0)

    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    raster = Raster(water, lower, upper, spacing)
    random = np.random.default_rng(seed)
    total = raster.volume.sum()
    mean = total / raster.wet.sum()
    d = mean if reference_depth is None else reference_depth
    if layout in ("lattice", "hexagonal"):
        x = _lattice(lower, upper, spacing, hexagonal=layout == "hexagonal")
        x = x[:, raster.at(*x) > THIN * d]
        volume = raster.at(*x)
        return x, volume * (total / volume.sum())
    wet = np.where(raster.volume > THIN * d * raster.wet, raster.wet, 0.0)
    share, part = (raster.volume, spacing**2 * d) if layout == "equal_mass" else (wet, spacing**2)
    count = share.sum() / part
    affordable(count, "columns of this depth", "fluid.spacing")
    x = raster.draw(share, max(round(count), 1), random)
    x = _jitter(x, raster, lower, upper, jitter * spacing, d if layout == "equal_mass" else None, random)
    x = relax_columns(x, raster, share, lower, upper, relax)
    volume = np.ones(x.shape[1]) if layout == "equal_mass" else np.maximum(raster.at(*x), THIN * d)
    return x, volume * (total / volume.sum())


def _jitter(x, raster, lower, upper, length, d, random):
    """Return places moved at random by at most ``length`` (at depth d, and as 1/sqrt(depth)) along each axis."""
    scale = length if d is None else length * np.sqrt(d / np.maximum(raster.at(*x), 0.1 * d))
    new = np.clip(x + scale * random.uniform(-1, 1, x.shape), lower[:, None], upper[:, None])
    return np.where(raster.at(*new) > 0, new, x)


def _lattice(lower, upper, spacing, hexagonal):
    """Points (2, n) of area spacing^2 each, half a step inside of the box; steps divide the box along y, and x."""
    row = spacing * np.sqrt(np.sqrt(0.75)) if hexagonal else spacing
    count = np.maximum(np.round((upper - lower) / [spacing**2 / row, row]), 1).astype(np.int64)
    step = (upper - lower) / count
    i, j = (a.ravel() for a in np.meshgrid(np.arange(count[0]), np.arange(count[1])))
    shift = 0.5 + (0.25 if hexagonal else 0.0) * np.where(j % 2, 1, -1)
    return lower[:, None] + step[:, None] * np.stack([i + shift, j + 0.5])
