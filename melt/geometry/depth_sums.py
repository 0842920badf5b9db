"""Depth of water columns as the sum of their neighbours, on the host: an independent check, start values, calibration.

A column is a place in the plane and a volume. Its depth and support radius fix each other,

    d_i = (sum_j V_j W(|x_i - x_j|, h_i) + wall) / (1 + bias),   h_i = ratio sqrt(V_i / d_i)

with the cubic spline of support radius h. Nothing here is shared with the stages.
"""

from itertools import chain
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from melt.errors import InputError
from melt.flood.lattice import normalisation

#: Columns never divide by less: the share of a support that walls may take is 1 - this.
LEAST_OPEN = 0.3


def weight(r, h):
    """Return the cubic spline W(r) of support radius h in the plane [1/m^2], not yet divided by 1 + bias."""
    q = np.minimum(2.0 * np.asarray(r) / h, 2.0)
    outer = 2 - q
    return 40 / (7 * np.pi * np.square(h)) * np.where(q < 1, 1 + q * q * (0.75 * q - 1.5), 0.25 * outer * outer * outer)


def _slope(r, h):
    """Return r dW/dr [1/m^2], zero or negative."""
    q = np.minimum(2.0 * np.asarray(r) / h, 2.0)
    outer = 2 - q
    return 40 / (7 * np.pi * np.square(h)) * q * np.where(q < 1, q * (2.25 * q - 3), -0.75 * outer * outer)


def lattice_bias(ratio, lattice="square"):
    """Return sum_lattice W A - 1 for columns on a lattice with support radius ``ratio`` sqrt(A).

    Raises:
        InputError: an unknown lattice.
    """
    if lattice not in ("square", "hexagonal"):
        raise InputError(f"lattice = {lattice!r}: square or hexagonal")
    return 1 / normalisation("cubic", ratio, lattice) - 1


class Near(NamedTuple):
    """Pairs (row, other) at distance r, rows ascending."""

    row: np.ndarray
    other: np.ndarray
    r: np.ndarray


def near(x, others, radius):
    """Return the `Near` pairs of points x (2, n) and ``others`` (2, m) within ``radius`` (n,) [m]."""
    lists = cKDTree(others.T).query_ball_point(x.T, radius, return_sorted=True)
    count = np.fromiter((len(a) for a in lists), np.int64, len(lists))
    other = np.fromiter(chain.from_iterable(lists), np.int64, int(count.sum()))
    row = np.repeat(np.arange(len(lists)), count)
    return Near(row, other, np.hypot(*(x[:, row] - others[:, other])))


class _Walls:
    """What walls add to columns: max(0, d_i + b_i - z_b) A_b W, all shares together at most 1 - `LEAST_OPEN`."""

    def __init__(self, x, radius, boundary, bed, norm=1.0):
        self.n, self.norm = x.shape[1], norm
        self.pairs = near(x, boundary[0], radius)
        self.area = boundary[1][self.pairs.other]
        sloped = len(boundary) > 2 and bed is not None
        self.level = bed[self.pairs.row] - boundary[2][self.pairs.other] if sloped else 0.0

    def __call__(self, depth, support):
        """Return what they add (n,) [m] and its derivative by depth."""
        row = self.pairs.row
        lift = depth[row] + self.level
        w = np.where(lift > 0, self.area * weight(self.pairs.r, support[row]), 0.0)
        share = np.bincount(row, w, self.n)
        bound = np.minimum(1.0, (1 - LEAST_OPEN) * self.norm / np.maximum(share, 1e-300))
        return bound * np.bincount(row, lift * w, self.n), bound * share


def wall_depth(x, depth, support, boundary, bed=None, norm=1.0):
    """Return what walls add to the sums of columns of known depth (n,) [m]; arguments as of `depth_of`."""
    if boundary is None or boundary[0].shape[1] == 0:
        return np.zeros(x.shape[1])
    return _Walls(x, support, boundary, bed, norm)(depth, support)[0]


class _Sums:
    """Depths of some columns as functions of these depths, for supports up to ``radius``."""

    def __init__(self, x, volume, rows, radius, norm, boundary, bed):
        self.n, self.norm = rows.size, norm
        self.fluid = near(x[:, rows], x, radius)
        self.mass = volume[self.fluid.other]
        some = boundary is not None and boundary[0].shape[1] > 0
        here = bed[rows] if some and bed is not None else None
        self.walls = _Walls(x[:, rows], radius, boundary, here, norm) if some else None

    def residual(self, depth, support):
        """Return depth - sums [m] and its derivative where the support follows the depth."""
        h = support[self.fluid.row]
        fluid = np.bincount(self.fluid.row, self.mass * weight(self.fluid.r, h), self.n)
        # W ~ f(r sqrt(d)) d, so that its derivative by d is (2 W + r W') / (2 d)
        slope = np.bincount(self.fluid.row, self.mass * _slope(self.fluid.r, h), self.n)
        total, rate = fluid, (2 * fluid + slope) / (2 * depth)
        if self.walls is not None:
            more, faster = self.walls(depth, support)
            total, rate = total + more, rate + faster
        return depth - total / self.norm, 1 - rate / self.norm


def depth_of(
    x, volume, ratio, h_limits, boundary=None, *, bed=None, bias=None, reference=None, tolerance=1e-12
):
    """Return (depth (n,) [m], support (n,) [m]): the fixed point of both, by bracketed Newton steps.

    Args:
        x: (2, n) places [m].
        volume: (n,) [m^3].
        ratio: support radius over sqrt(V/d), 2.66 unless one knows better.
        h_limits: (least, most) support radius [m]; where it binds, depth is the sum at that support.
        boundary: (places (2, m) [m], areas (m,) [m^2]) or with a third entry, elevations of the bed there
            (m,) [m]; walls mirror the stage: each adds max(0, d_i + b_i - z_b) A_b W. Two entries: flat bed.
        bed: (n,) elevation of the bed at the columns [m], to go with elevations of the boundary.
        bias: of the lattice sum, that of the square lattice unless given.
        reference: (n,) volume that fixes the support in place of ``volume`` [m^3]: that before `calibrate`.
    """
    x, volume = np.asarray(x, float), np.asarray(volume, float)
    reference = volume if reference is None else np.asarray(reference, float)
    n = volume.size
    least, most = (np.broadcast_to(np.asarray(limit, float), n) for limit in h_limits)
    bias = lattice_bias(ratio) if bias is None else bias
    depth, support = np.zeros(n), np.array(most)
    if n == 0:
        return depth, support
    radius = np.clip(1.25 * _guess(x, ratio), least, most)
    todo = np.arange(n)
    while todo.size:
        sums = _Sums(x, volume, todo, radius[todo], 1 + bias, boundary, bed)
        depth[todo], support[todo] = _solve(
            sums, reference[todo], ratio, least[todo], radius[todo], tolerance
        )
        todo = todo[(support[todo] >= radius[todo] * (1 - 1e-9)) & (radius[todo] < most[todo])]
        radius[todo] = np.minimum(1.5 * radius[todo], most[todo])
    return depth, support


def _guess(x, ratio):
    """Support radius from the distance of the 12th neighbour."""
    k = min(13, x.shape[1])
    far = cKDTree(x.T).query(x.T, k=k)[0].reshape(x.shape[1], k)[:, -1]
    return np.maximum(ratio * far * np.sqrt(np.pi / 13), 1e-300 + far.max(initial=0.0) * 1e-6)


def _solve(sums, volume, ratio, least, most, tolerance):
    """Return depth and support of the rows of ``sums`` with support in [least, most]."""

    def support_of(depth):
        return np.clip(ratio * np.sqrt(volume / depth), least, most)

    low, high = ratio**2 * volume / most**2, ratio**2 * volume / least**2
    # where a limit of the support binds there is no root: the sum at that support is the depth
    sparse, crowded = sums.residual(low, most)[0] >= 0, sums.residual(high, least)[0] <= 0
    bound = sparse | crowded
    depth = np.where(sparse, low, np.where(crowded, high, np.minimum(1.5625 * low, high)))
    for _ in range(60):
        value, slope = sums.residual(depth, support_of(depth))
        high, low = np.where(value > 0, depth, high), np.where(value > 0, low, depth)
        step = depth - value / np.where(slope > 0, slope, np.inf)
        new = np.where((step >= low) & (step <= high) & (slope > 0), step, np.sqrt(low * high))
        new = np.where(bound, depth, new)
        moved, depth = np.abs(new - depth) / depth, new
        if moved.max() < tolerance:
            break
    support = support_of(depth)
    for _ in range(60 if bound.any() else 0):  # walls mirror the depth: a sum that contains it
        step = np.where(bound, sums.residual(depth, support)[0], 0.0)
        depth = np.maximum(depth - step, 1e-300)
        if (np.abs(step) <= tolerance * depth).all():
            break
    return depth, support
