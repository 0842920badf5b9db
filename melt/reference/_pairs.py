"""All-pairs tables of the reference: float64, dense, in the paper's symbols."""

import numpy as np


def separations(position):
    """Return x_ij = x_i - x_j, shape (3, n, n), and r_ij, shape (n, n) [m]."""
    x = np.asarray(position, dtype=np.float64)
    x_ij = x[:, :, None] - x[:, None, :]
    return x_ij, np.sqrt((x_ij**2).sum(axis=0))


def W(r, smoothing):
    """Return W(r) [1/m^3]. Melting spec 2.1: 0 cubic, 1 Wendland C2, 2 poly6."""
    h = float(smoothing.support)
    q = np.asarray(r, dtype=np.float64) / h
    flat = smoothing.dimension == 2
    if smoothing.kernel == 0:
        s = 40 / (7 * np.pi * h**2) if flat else 8 / (np.pi * h**3)
        inner = s * (6 * q**3 - 6 * q**2 + 1)
        return np.where(q <= 0.5, inner, np.where(q < 1, 2 * s * (1 - q) ** 3, 0.0))
    if smoothing.kernel == 1:
        s = 7 / (np.pi * h**2) if flat else 21 / (2 * np.pi * h**3)
        return np.where(q < 1, s * (1 - q) ** 4 * (4 * q + 1), 0.0)
    return np.where(q < 1, 315 / (64 * np.pi * h**9) * (h**2 - (q * h) ** 2) ** 3, 0.0)


def dW(r, smoothing):
    """Return W'(r) [1/m^4]: of the cubic spline, Wendland C2, or spiky."""
    h = float(smoothing.support)
    q = np.asarray(r, dtype=np.float64) / h
    flat = smoothing.dimension == 2
    if smoothing.kernel == 0:
        s = 40 / (7 * np.pi * h**3) if flat else 8 / (np.pi * h**4)
        inner = s * (18 * q**2 - 12 * q)
        return np.where(q <= 0.5, inner, np.where(q < 1, -6 * s * (1 - q) ** 2, 0.0))
    if smoothing.kernel == 1:
        s = -140 / (np.pi * h**3) if flat else -210 / (np.pi * h**4)
        return np.where(q < 1, s * q * (1 - q) ** 3, 0.0)
    return np.where(q < 1, -45 / (np.pi * h**6) * (h - q * h) ** 2, 0.0)


def gradW(x_ij, r, smoothing):
    """Return gradW_ij = W'(r) x_ij / r, shape as x_ij; 0 for r < 1e-9 h."""
    apart = r >= 1e-9 * float(smoothing.support)
    return np.where(apart, dW(r, smoothing) / np.where(apart, r, 1.0), 0.0) * x_ij


def L(r, smoothing):
    """Return the Laplacian weight L(r) [1/m^5]: 0 viscosity, 1 Brookshaw, 2 regularised."""
    h = float(smoothing.support)
    r = np.asarray(r, dtype=np.float64)
    if smoothing.laplacian == 0:
        return np.where(r < h, 45 / (np.pi * h**6) * (h - r), 0.0)
    r = np.maximum(r, 1e-9 * h)
    if smoothing.laplacian == 1:
        return -2 * dW(r, smoothing) / r
    return -2 * dW(r, smoothing) * r / (r**2 + 0.01 * (h / 2) ** 2)
