"""Exact solutions of incompressible liquids: start-up between plates, ellipses that stretch or swing. Slime spec 5."""

import functools

import numpy as np


def couette(z, t, H, nu, speed):
    """Return the velocity at height z after t seconds below a plate that moves: a linear profile and its Fourier series [m/s]."""
    n = np.arange(1, 200)[:, None]
    waves = (2 * speed / (n * np.pi) * (-1.0) ** n * np.sin(n * np.pi * z / H) * np.exp(-nu * (n * np.pi / H) ** 2 * t)).sum(axis=0)
    return speed * z / H + waves


def poiseuille(z, t, H, nu, force):
    """Return the velocity between plates at rest, driven by an acceleration ``force`` [m/s]."""
    n = (2 * np.arange(200) + 1)[:, None]
    waves = (4 * force * H**2 / (nu * np.pi**3 * n**3) * np.sin(n * np.pi * z / H) * np.exp(-nu * (n * np.pi / H) ** 2 * t)).sum(axis=0)
    return force / (2 * nu) * z * (H - z) - waves


@functools.lru_cache(8)
def axes_of(rate, end, central=0.0, a=1.0, b=1.0, steps=20_000):
    """Return times, and the semi-axes along x and z of the exact ellipse: A' = (A^2 + B^2)(b^2 - a^2)/(a^2 + b^2), a' = A a."""

    def slope(y):
        A, a, b = y
        return np.array([(A * A + central) * (b * b - a * a) / (a * a + b * b), A * a, -A * b])

    y, dt, rows = np.array([rate, a, b]), end / steps, []
    for _ in range(steps + 1):
        rows.append(y)
        k1 = slope(y)
        k2 = slope(y + dt / 2 * k1)
        k3 = slope(y + dt / 2 * k2)
        y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + slope(y + dt * k3))
    rows = np.array(rows)
    return np.linspace(0, end, steps + 1), rows[:, 1], rows[:, 2]


def axes(x, m):
    """Return semi-axes along x and z from second moments: those of an ellipse are a^2/4, b^2/4; x (n, 2) [m], m (n,)."""
    d = x - np.average(x, axis=0, weights=m)
    return 2 * np.sqrt(np.average(d**2, axis=0, weights=m))
