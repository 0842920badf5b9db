"""Rays of pixels, for the reference of the screen-space renderer."""

import numpy as np


def rays(shape, view, step=1):
    """Return (u, v) of the rays (u, v, 1) through the centres of pixels that are ``step`` wide."""
    height, width = shape
    u = ((np.arange(width) + 0.5) * step - float(view.centre_x)) / float(view.focal)
    v = ((np.arange(height) + 0.5) * step - float(view.centre_y)) / float(view.focal)
    return np.broadcast_to(u[None, :], shape), np.broadcast_to(v[:, None], shape)


def halved(image, shape):
    """Return every second pixel of every second row, as half resolution sees a full one."""
    height, width = image.shape
    rows, columns = np.minimum(2 * np.arange(shape[0]), height - 1), np.minimum(2 * np.arange(shape[1]), width - 1)
    return image[rows[:, None], columns[None, :]].astype(np.float64)


def doubled(image, shape):
    """Return an image (..., h, w) of half resolution at the pixels of the full one, bilinear."""
    h, w = image.shape[-2:]
    y = np.clip((np.arange(shape[0]) + 0.5) / 2 - 0.5, 0, h - 1)
    x = np.clip((np.arange(shape[1]) + 0.5) / 2 - 0.5, 0, w - 1)
    r, c = np.minimum(y.astype(int), max(h - 2, 0)), np.minimum(x.astype(int), max(w - 2, 0))
    a, b = (y - r)[:, None], (x - c)[None, :]
    r1, c1 = np.minimum(r + 1, h - 1), np.minimum(c + 1, w - 1)
    f = image.astype(np.float64)
    top = (1 - b) * f[..., r[:, None], c] + b * f[..., r[:, None], c1]
    low = (1 - b) * f[..., r1[:, None], c] + b * f[..., r1[:, None], c1]
    return (1 - a) * top + a * low


def spheres(screen_sphere, screen_box):
    """Yield (number, x, y, z, radius) of the spheres that are drawn."""
    for i in range(screen_sphere.shape[1]):
        if screen_box[1, i] >= screen_box[0, i]:
            yield (i, *(float(v) for v in screen_sphere[:, i]))


def pierce(u, v, x, y, z, r):
    """Return (entry depth, chord, hit) of rays (u, v, 1) and the sphere: |t d - c|^2 = r^2, nearer root."""
    dd, dc = u * u + v * v + 1, u * x + v * y + z
    m2 = ((u * y - v * x) ** 2 + (u * z - x) ** 2 + (v * z - y) ** 2) / dd  # |d x c|^2 / |d|^2
    left = np.maximum(r * r - m2, 0)
    return dc / dd - np.sqrt(left / dd), 2 * np.sqrt(left), m2 < r * r
