r"""Normals and light. Flood spec 5, R4 and R6 (van der Laan 2009).

.. math:: C = a (1 - F) + b F + k_s (n \cdot h)^\alpha, \quad a = C_f (1 - e^{-\kappa T}) + S\, e^{-\kappa T},
    \quad F = F_0 + (1 - F_0)(1 - n \cdot v)^5

S is what lies behind at p - beta_r n_xy T f/D, b the sky along the reflection, h halfway between eye and sun.
"""

import numpy as np

from melt.reference._screen import doubled, rays


def _slope(D, axis):
    """Return the difference to the neighbour nearer in depth along an axis, and the step to it (+1, -1, or 0 for none)."""
    ahead, back = np.full(D.shape, np.inf), np.full(D.shape, np.inf)
    one, two = [slice(None)] * 2, [slice(None)] * 2
    one[axis], two[axis] = slice(None, -1), slice(1, None)
    one, two = tuple(one), tuple(two)
    with np.errstate(invalid="ignore"):
        gap = np.diff(D, axis=axis)
    ahead[one], back[two] = np.where(np.isfinite(gap), gap, np.inf), np.where(np.isfinite(gap), -gap, np.inf)
    step = np.where(np.isinf(ahead) & np.isinf(back), 0, np.where(np.abs(ahead) <= np.abs(back), 1, -1))
    return np.where(step == 0, 0, np.where(step == 1, ahead, back)), step


def screen_normal(screen_depth, view, screen_normal):
    """Write unit normals towards the eye, in the camera frame; (0, 0, -1) where there is no liquid.

    n is the direction of dP/dx x dP/dy with P = D (u, v, 1), of the nearer neighbours in depth on each axis.
    Reads: screen_depth (h, w) [m]. Writes: screen_normal (3, h, w).
    """
    D = screen_depth.astype(np.float64)
    u, v = rays(D.shape, view)
    some, f = np.isfinite(D), float(view.focal)
    D0 = np.where(some, D, 1.0)
    tangents = []
    for axis, along in ((1, 0), (0, 1)):
        gap, step = _slope(D, axis)
        gap = np.where(some, gap, 0)
        moved = np.where(step == 0, 1, step) / f  # a lone pixel faces the eye
        t = np.stack([u * gap, v * gap, gap])
        t[along] += moved * (D0 + gap)  # P(p + 1) - P(p), written without the large terms
        tangents.append(t * np.where(step == -1, -1, 1))
    n = -np.cross(*tangents, axis=0)
    n /= np.sqrt((n**2).sum(axis=0))
    screen_normal[:] = np.where(some, n, np.array([0, 0, -1.0])[:, None, None])


def _colour(optics, name):
    return np.array([getattr(optics, f"{name}_{k}") for k in ("red", "green", "blue")], np.float64)[:, None, None]


def _axis(optics, name):
    return np.array([getattr(optics, f"{name}_{k}") for k in "xyz"], np.float64)[:, None, None]


def _sky(direction, optics):
    rise = (direction * _axis(optics, "up")).sum(axis=0)
    up, down = np.clip(1.6 * rise, 0, 1), np.clip(-4 * rise, 0, 1)
    return up * _colour(optics, "zenith") + down * _colour(optics, "nadir") + (1 - up - down) * _colour(optics, "horizon")


def _behind(x, y, D, behind_depth, behind_colour):
    """Return the colour behind at pixels (x, y), bilinear over those that are not in front of the liquid."""
    h, w = D.shape
    x, y = np.clip(x, 0, w - 1), np.clip(y, 0, h - 1)
    c, r = np.minimum(x.astype(int), max(w - 2, 0)), np.minimum(y.astype(int), max(h - 2, 0))
    total, weight = np.zeros((3, h, w)), np.zeros((h, w))
    for j, i in ((0, 0), (0, 1), (1, 0), (1, 1)):
        rr, cc = np.minimum(r + j, h - 1), np.minimum(c + i, w - 1)
        part = np.abs(1 - j - (y - r)) * np.abs(1 - i - (x - c)) * (behind_depth[rr, cc] >= D)
        total += part * behind_colour[:, rr, cc]
        weight += part
    own = behind_colour.astype(np.float64)
    return np.where(weight > 1e-3, total / np.maximum(weight, 1e-3), own)


def screen_shade(
    screen_depth, screen_normal, screen_length, screen_value, screen_map, behind_depth, behind_colour,
    view, optics, picture,
):
    """Write the colour of every pixel: liquid in front of what is behind it, which stays as it is elsewhere.

    Reads: screen_depth (h, w) [m], screen_normal (3, h, w), screen_length (h/2, w/2) [m], screen_value
        (2, h/2, w/2), screen_map (3, stops), behind_depth (h, w) [m], behind_colour (3, h, w).
    Writes: picture (3, h, w).
    """
    D, n = screen_depth.astype(np.float64), screen_normal.astype(np.float64)
    some = np.isfinite(D)
    D0 = np.where(some, D, 1.0)
    T = np.where(some, doubled(screen_length, D.shape), 0)
    u, v = rays(D.shape, view)
    ray = np.stack([u, v, np.ones_like(u)])
    ray /= np.sqrt((ray**2).sum(axis=0))
    facing = -(ray * n).sum(axis=0)
    F = float(optics.fresnel) + (1 - float(optics.fresnel)) * np.clip(1 - facing, 0, 1) ** 5
    b = _sky(ray + 2 * facing * n, optics)
    sun = _axis(optics, "sun")
    half = sun - ray
    half /= np.sqrt((half**2).sum(axis=0))
    shine = float(optics.shine) * np.maximum((n * half).sum(axis=0), 0) ** (2.0 ** int(optics.doublings))
    light = float(optics.ambient) + (1 - float(optics.ambient)) * np.maximum((n * sun).sum(axis=0), 0)
    C = _colour(optics, "body")
    if optics.mapped:
        value, weight = doubled(screen_value, D.shape)
        at = np.clip(value / np.maximum(weight, 1e-4), 0, 1) * (screen_map.shape[1] - 1)
        C = np.stack([np.interp(at, np.arange(screen_map.shape[1]), channel) for channel in screen_map.astype(np.float64)])
    shift = float(optics.refraction) * T * float(view.focal) / D0
    h, w = D.shape
    x, y = np.arange(w)[None, :] - shift * n[0], np.arange(h)[:, None] - shift * n[1]
    S = _behind(x, y, np.where(some, D, 0), behind_depth, behind_colour)
    through = np.exp(-_colour(optics, "absorb") * T)
    a = C * light * (1 - through) + S * through
    picture[:] = np.where(some, a * (1 - F) + b * F + shine, behind_colour)
