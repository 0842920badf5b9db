"""Kernels in two dimensions, terrain samplers and pair tables of the flood: float64, all pairs, the spec's symbols."""

import numpy as np


def W2(r, h, flood):
    """Return W(r, h) [1/m^2] with l = h/2: 0 cubic spline, 1 Wendland C2. Flood spec 0."""
    ell = np.asarray(h, dtype=np.float64) / 2
    q = np.asarray(r, dtype=np.float64) / ell
    if flood.kernel == 0:
        s = float(flood.sigma) * 10 / (7 * np.pi * ell**2)
        inner, outer = s * (1 - 1.5 * q**2 + 0.75 * q**3), s * 0.25 * (2 - q) ** 3
        return np.where(q < 1, inner, np.where(q < 2, outer, 0.0))
    s = float(flood.sigma) * 7 / (4 * np.pi * ell**2)
    return np.where(q < 2, s * (1 - q / 2) ** 4 * (1 + 2 * q), 0.0)


def dW2(r, h, flood):
    """Return dW/dr(r, h) [1/m^3]."""
    ell = np.asarray(h, dtype=np.float64) / 2
    q = np.asarray(r, dtype=np.float64) / ell
    if flood.kernel == 0:
        s = float(flood.sigma) * 10 / (7 * np.pi * ell**2) / ell
        return np.where(q < 1, s * (-3 * q + 2.25 * q**2), np.where(q < 2, -s * 0.75 * (2 - q) ** 2, 0.0))
    s = float(flood.sigma) * 7 / (4 * np.pi * ell**2) / ell
    return np.where(q < 2, -s * 5 * q * (1 - q / 2) ** 3, 0.0)


def apart(position, others):
    """Return the distances (n, m) in the plane of n columns from m places."""
    x, y = position[:2].astype(np.float64), others[:2].astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        return np.sqrt((x[0, :, None] - y[0]) ** 2 + (x[1, :, None] - y[1]) ** 2)


def _weights(t, count, sampler):
    """Return nodes (s, n) and their weights of value, slope and curvature at coordinates t in node distances."""
    t = np.clip(np.nan_to_num(t, nan=-2.0), -2, count + 1)
    if sampler == 0:  # E5
        k = np.floor(t + 0.5).astype(np.int64)
        u, one = t - k, np.ones_like(t)
        value = [0.5 * (0.5 - u) ** 2, 0.75 - u**2, 0.5 * (0.5 + u) ** 2]
        slope, curvature, first = [-(0.5 - u), -2 * u, 0.5 + u], [one, -2 * one, one], -1
    elif sampler == 1:
        k = np.floor(t).astype(np.int64)
        u, one = t - k, np.ones_like(t)
        value, slope, curvature, first = [1 - u, u], [-one, one], [0 * u, 0 * u], 0
    else:  # Catmull-Rom
        k = np.floor(t).astype(np.int64)
        u, first = t - k, -1
        value = [-0.5 * u**3 + u**2 - 0.5 * u, 1.5 * u**3 - 2.5 * u**2 + 1, -1.5 * u**3 + 2 * u**2 + 0.5 * u, 0.5 * u**3 - 0.5 * u**2]
        slope = [-1.5 * u**2 + 2 * u - 0.5, 4.5 * u**2 - 5 * u, -4.5 * u**2 + 4 * u + 0.5, 1.5 * u**2 - u]
        curvature = [-3 * u + 2, 9 * u - 5, -9 * u + 4, 3 * u - 1]
    nodes = np.clip(k + first + np.arange(len(value))[:, None], 0, count - 1)
    return nodes, np.array(value), np.array(slope), np.array(curvature)


def sample(position, field, grid, sampler):
    """Return (f, df/dx, df/dy, fxx, fyy, fxy) of a field of the nodes at places (2 or 3, n)."""
    z = np.asarray(field, dtype=np.float64).reshape(int(grid.ny), int(grid.nx))
    p, q = float(grid.inverse_dx), float(grid.inverse_dy)
    with np.errstate(invalid="ignore", over="ignore"):
        i, *wx = _weights((position[0].astype(np.float64) - float(grid.origin_x)) * p, int(grid.nx), sampler)
        j, *wy = _weights((position[1].astype(np.float64) - float(grid.origin_y)) * q, int(grid.ny), sampler)
    nodes = z[j[:, None], i[None, :]]
    found = []
    for a, b, scale in ((0, 0, 1.0), (1, 0, p), (0, 1, q), (2, 0, p * p), (0, 2, q * q), (1, 1, p * q)):
        found.append(scale * np.einsum("bn,an,ban->n", wy[b], wx[a], nodes))
    return found
