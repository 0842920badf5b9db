"""Volumes of columns such that their sums give the wanted depths."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from melt.geometry.depth_sums import lattice_bias, near, wall_depth, weight

#: A sweep changes a volume by no more than this factor, all sweeps together neither.
MOST = 2.0


class Calibration(NamedTuple):
    """What `calibrate` did, as shares of 1."""

    sweeps: int
    before: float  # largest |sum / target - 1| at the start
    error: float  # what is left of it
    rms: float  # root mean square of what is left
    change: float  # of the total volume
    largest: float  # change of a column's volume
    bound: int  # columns that would need more than a factor `MOST`
    support: np.ndarray  # (n,) radius that the sums were taken with: that of the volumes before [m]


def measured_bias(x, volume, target_depth, ratio, boundary=None, *, bed=None):
    """Return how much too deep the sums are on average (weighed by volume), to divide the kernel by 1 + it.

    Relaxed columns lie between a square lattice (0.05 %) and a hexagonal one (0.47 %).
    """
    x, volume, target = np.asarray(x, float), np.asarray(volume, float), np.asarray(target_depth, float)
    support = ratio * np.sqrt(volume / target)
    pairs = near(x, x, support)
    water = np.bincount(pairs.row, volume[pairs.other] * weight(pairs.r, support[pairs.row]), volume.size)
    found = (water + wall_depth(x, target, support, boundary, bed)) / target
    return float(volume @ found / volume.sum() - 1)


def calibrate(x, volume, target_depth, ratio, boundary=None, sweeps=400, *, bed=None, bias=None, tolerance=1e-6):
    """Return (volume (n,) [m^3], `Calibration`): sums of neighbours that equal the target depths.

    Each sweep does V_i <- V_i d_target / d_sum at the supports ratio sqrt(V_i / d_target) of the first volumes. They
    stay: if they followed the volumes, a common factor would change no depth (h^2 grows with V), and nothing could
    be calibrated. A solver must therefore keep these supports as its reference (`depth_of` takes them as
    ``reference`` = the volumes before).

    The first sweeps even out what is smooth; the last digits of rough errors cost large, alternating changes of
    volume. Where water thins out to nothing, or ends freely, no positive volumes give the depth: those columns stop
    at a factor `MOST`. Arguments as of `melt.geometry.depth_sums.depth_of`; ``tolerance`` ends the sweeps.
    """
    x, first, target = np.asarray(x, float), np.asarray(volume, float), np.asarray(target_depth, float)
    n, volume = first.size, np.array(first)
    bias = lattice_bias(ratio) if bias is None else bias
    support = ratio * np.sqrt(first / target)
    if n == 0:
        return volume, Calibration(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, support)
    pairs = near(x, x, support)
    values = weight(pairs.r, support[pairs.row]) / ((1 + bias) * target[pairs.row])
    matrix = csr_matrix((values, (pairs.row, pairs.other)), (n, n))
    wall = wall_depth(x, target, support, boundary, bed, 1 + bias) / ((1 + bias) * target)
    before, done = None, 0
    while True:
        found = matrix @ volume + wall
        error = np.abs(found - 1).max()
        before = error if before is None else before
        if error <= tolerance or done >= sweeps:
            break
        # only the water's own part can be changed
        factor = np.maximum(1 - wall, 1e-3) / np.maximum(found - wall, 1e-300)
        volume = np.clip(volume * np.clip(factor, 1 / MOST, MOST), first / MOST, first * MOST)
        done += 1
    moved = volume / first
    bound = int(((moved <= 1 / MOST) | (moved >= MOST)).sum())
    return volume, Calibration(
        done, before, error, float(np.sqrt(np.mean(np.square(found - 1)))), volume.sum() / first.sum() - 1,
        np.abs(moved - 1).max(), bound, support,
    )
