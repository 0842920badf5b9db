r"""Smoothing of depth and thickness. Flood spec 5, R3, R5.

.. math:: D'_i = \frac{\sum_j w_s w_r D_j}{\sum_j w_s w_r}, \quad w_s = e^{-|i-j|^2 / 2\sigma_s^2}, \quad
    w_r = e^{-(D_i - D_j)^2 / 2\sigma_r^2}, \quad \sigma_s = \mathrm{clamp}(f \sigma_w / D_i)

over pixels j with liquid, at most 2.5 sigma_s away (at which w_s is 0.044).
"""

import numpy as np


def _sigma(D, filter, view):
    with np.errstate(divide="ignore"):
        return np.clip(float(view.focal) * float(filter.size) / D, float(filter.smallest), float(filter.largest))


def _reach(filter):
    return int(2.5 * float(filter.largest))


def _weighted(D, offsets, filter, view):
    """Return the bilateral mean over the pixels at ``offsets``, list of (rows, columns)."""
    height, width = D.shape
    sigma, reach = _sigma(D, filter, view), _reach(filter)
    padded = np.pad(D, reach, constant_values=np.inf)
    total, weight = np.zeros(D.shape), np.zeros(D.shape)
    for r, c in offsets:
        other = padded[reach + r : reach + r + height, reach + c : reach + c + width]
        some = np.isfinite(other) & np.isfinite(D) & (r * r + c * c <= (2.5 * sigma) ** 2)
        gap = np.where(some, other, 0) - np.where(some, D, 0)
        w = np.exp(-(r * r + c * c) / (2 * sigma**2)) * np.exp(-(gap**2) / (2 * float(filter.range) ** 2))
        total += np.where(some, w * gap, 0)
        weight += np.where(some, w, 0)
    return np.where(np.isfinite(D), D + total / np.maximum(weight, 1e-30), np.inf)


def bilateral(screen_depth, filter, view, screen_depth_next):
    """Write the depth, smoothed by the whole two-dimensional window; pixels without liquid stay so.

    Reads: screen_depth (height, width) [m]. Writes: screen_depth_next likewise.
    """
    far = range(-_reach(filter), _reach(filter) + 1)
    screen_depth_next[:] = _weighted(screen_depth.astype(np.float64), [(r, c) for r in far for c in far], filter, view)


def bilateral_pass(screen_depth, filter, view, along, screen_depth_next):
    """Write the depth, smoothed along rows (``along`` 0) or columns (1): two passes stand for `bilateral`."""
    far = range(-_reach(filter), _reach(filter) + 1)
    offsets = [(k, 0) if along else (0, k) for k in far]
    screen_depth_next[:] = _weighted(screen_depth.astype(np.float64), offsets, filter, view)


def narrow_pass(screen_depth, filter, view, along, screen_depth_next):
    """Write the depth after one pass of the narrow-range filter (Truong and Yuksel 2018).

    Pixels are taken in pairs i - k, i + k. What is nearer than the window is left out together with its partner,
    what is farther counts as D_i + mu; the window [D_i - delta, D_i + delta] grows with what it holds.
    """
    D = screen_depth.astype(np.float64)
    D = D.T if along else D
    sigma, out = _sigma(D, filter, view), np.full(D.shape, np.inf)
    delta, mu = float(filter.narrow), float(filter.clamp)
    for i, j in zip(*np.nonzero(np.isfinite(D))):
        centre = D[i, j]
        low, high = centre - delta, centre + delta
        total = weight = 0.0
        for k in range(1, int(2.5 * sigma[i, j]) + 1):
            pair = [D[i, m] for m in (j - k, j + k) if 0 <= m < D.shape[1] and np.isfinite(D[i, m])]
            if len(pair) < 2 or min(pair) < low:
                continue
            w = np.exp(-k * k / (2 * sigma[i, j] ** 2))
            inside = [d for d in pair if d <= high]
            total += w * sum(d - centre if d <= high else mu for d in pair)
            weight += 2 * w
            low, high = min([low, *(d - delta for d in inside)]), max([high, *(d + delta for d in inside)])
        out[i, j] = centre + total / (1 + weight)
    screen_depth_next[:] = out.T if along else out


def screen_blur(screen_length, deviation, along, screen_length_next):
    """Write the thickness after a Gaussian blur along rows (``along`` 0) or columns (1), edges repeated.

    ``deviation`` [px of half resolution]: standard deviation; the window ends at 2.5 of it.
    """
    reach, h, w = int(2.5 * float(deviation)), *screen_length.shape
    k = np.arange(-reach, reach + 1)
    weight = np.exp(-(k**2) / (2 * float(deviation) ** 2))
    rows, columns = np.arange(h)[:, None], np.arange(w)[None, :]
    moved = [(np.clip(rows + i, 0, h - 1), columns) if along else (rows, np.clip(columns + i, 0, w - 1)) for i in k]
    f = screen_length.astype(np.float64)
    screen_length_next[:] = sum(a * f[at] for a, at in zip(weight, moved)) / weight.sum()
