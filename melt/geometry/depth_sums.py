"""Depth of water columns as the sum of their neighbours, on the host: an independent check, start values, calibration.

A column is a place in the plane and a volume. Its depth and support radius fix each other,

    d_i = (sum_j V_j W(|x_i - x_j|, h_i) + wall) / (1 + bias),   h_i = ratio sqrt(V_i / d_i)

with the cubic spline of support radius h. Nothing here is shared with the stages.
"""

from itertools import chain
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from melt.errors import InputError

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
    reach = int(np.ceil(2 * ratio)) + 1
    i, j = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1))
    if lattice == "hexagonal":
        edge = np.sqrt(2 / np.sqrt(3))
        r = edge * np.hypot(i + 0.5 * j, np.sqrt(0.75) * j)
    else:
        r = np.hypot(i, j)
    return float(weight(r, ratio).sum() - 1)


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


class _Sums:
    """Terms of the depth of some columns as functions of their depth, for supports up to ``radius``."""

    def __init__(self, x, volume, rows, radius, ratio, bias, boundary, bed):
        self.volume, self.scale, self.n = volume[rows], ratio**2, rows.size
        self.norm = 1 + bias
        self.fluid = near(x[:, rows], x, radius)
        self.mass = volume[self.fluid.other]
        self.wall = None
        if boundary is not None and boundary[0].shape[1]:
            self.wall = near(x[:, rows], boundary[0], radius)
            self.area = boundary[1][self.wall.other]
            level = 0.0 if len(boundary) < 3 or bed is None else bed[rows][self.wall.row] - boundary[2][self.wall.other]
            self.level = np.broadcast_to(level, self.area.shape)

    def residual(self, depth, support):
        """Return depth - sums [m] and its derivative where the support follows the depth."""
        fluid = np.bincount(self.fluid.row, self.mass * weight(self.fluid.r, support[self.fluid.row]), self.n)
        # d(sum)/dd at h ~ 1/sqrt(d): W = d f(r sqrt(d)) gives (2 W + r W') / (2 d)
        slope = np.bincount(self.fluid.row, self.mass * _slope(self.fluid.r, support[self.fluid.row]), self.n)
        total, rate = fluid, (2 * fluid + slope) / (2 * depth)
        if self.wall is not None:
            row = self.wall.row
            w = self.area * weight(self.wall.r, support[row])
            lift = np.maximum(depth[row] + self.level, 0.0)
            share = np.bincount(row, np.where(lift > 0, w, 0.0), self.n)
            # the share walls take is bounded as in the stage, so that depth stays finite in a corner
            bound = np.minimum(1.0, (1 - LEAST_OPEN) * self.norm / np.maximum(share, 1e-300))
            total = total + bound * np.bincount(row, lift * w, self.n)
            rate = rate + bound * share
        return depth - total / self.norm, 1 - rate / self.norm


def depth_of(x, volume, ratio, h_limits, boundary=None, *, bed=None, bias=None, tolerance=1e-12):
    """Return (depth (n,) [m], support (n,) [m]): the fixed point of both, by bracketed Newton steps.

    Args:
        x: (2, n) places [m].
        volume: (n,) [m^3].
        ratio: support radius over sqrt(V/d), 2.66 unless one knows better.
        h_limits: (least, most) support radius [m]; where it binds, depth is the sum at that support.
        boundary: (places (2, m) [m], areas (m,) [m^2]) or with a third entry, elevations of the bed there
            (m,) [m]; walls mirror the stage: each adds max(0, d_i + b_i - z_b) A_b W. Two entries: flat bed.
        bed: (n,) elevation of the bed at the columns [m], needed with elevations of the boundary.
        bias: of the lattice sum, that of the square lattice unless given.
    """
    x, volume = np.asarray(x, float), np.asarray(volume, float)
    n = volume.size
    least, most = (np.broadcast_to(np.asarray(limit, float), n) for limit in h_limits)
    bias = lattice_bias(ratio) if bias is None else bias
    depth, support = np.zeros(n), np.array(most)
    if n == 0:
        return depth, support
    radius = np.clip(1.25 * _guess(x, ratio), least, most)
    todo = np.arange(n)
    while todo.size:
        sums = _Sums(x, volume, todo, radius[todo], ratio, bias, boundary, bed)
        depth[todo], support[todo] = _solve(sums, ratio, least[todo], radius[todo], tolerance)
        todo = todo[(support[todo] >= radius[todo] * (1 - 1e-9)) & (radius[todo] < most[todo])]
        radius[todo] = np.minimum(1.5 * radius[todo], most[todo])
    return depth, support


def _guess(x, ratio):
    """Support radius from the distance of the 12th neighbour."""
    k = min(13, x.shape[1])
    far = cKDTree(x.T).query(x.T, k=k)[0].reshape(x.shape[1], k)[:, -1]
    return np.maximum(ratio * far * np.sqrt(np.pi / 13), 1e-300 + far.max(initial=0.0) * 1e-6)


def _solve(sums, ratio, least, most, tolerance):
    """Return depth and support of the rows of ``sums`` with support in [least, most]."""

    def support_of(depth):
        return np.clip(ratio * np.sqrt(volume / depth), least, most)

    volume = sums.volume
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
