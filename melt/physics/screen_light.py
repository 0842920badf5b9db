"""Formulas of shading that both twins use: slopes of the depth, look-ups in pictures, light. Flood spec 5, R4, R6."""

import math

from melt._compile import scalar, scalar_lookup
from melt.physics.screen import decay, schlick, sky


@scalar
def slope(depth, ahead, back, none):
    """Return the difference to the nearer neighbour in depth, in the direction of the axis, and its sign (0: alone)."""
    real = type(depth)
    forward = ahead - depth if ahead < none else none
    backward = back - depth if back < none else none
    if forward == none and backward == none:
        return real(0), real(0)
    if abs(forward) <= abs(backward):
        return forward, real(1)
    return backward, real(-1)


@scalar_lookup
def doubled(image, row, column):
    """Return an image of half resolution at a pixel of the full one, bilinear."""
    real = image.dtype.type
    h, w = image.shape
    y = min(max(real(row) * real(0.5) - real(0.25), real(0)), real(h - 1))
    x = min(max(real(column) * real(0.5) - real(0.25), real(0)), real(w - 1))
    r, c = min(int(y), max(h - 2, 0)), min(int(x), max(w - 2, 0))
    a, b, r1, c1 = y - real(r), x - real(c), min(r + 1, h - 1), min(c + 1, w - 1)
    top = image[r, c] + b * (image[r, c1] - image[r, c])
    low = image[r1, c] + b * (image[r1, c1] - image[r1, c])
    return top + a * (low - top)


@scalar_lookup
def behind(x, y, depth, own, behind_depth, behind_colour):
    """Return the colour behind at pixel (x, y), bilinear over what is not in front of the liquid, else ``own``."""
    real = type(x)
    h, w = behind_depth.shape
    x, y = min(max(x, real(0)), real(w - 1)), min(max(y, real(0)), real(h - 1))
    c, r = min(int(x), max(w - 2, 0)), min(int(y), max(h - 2, 0))
    b, a, c1, r1 = x - real(c), y - real(r), min(c + 1, w - 1), min(r + 1, h - 1)
    one, none = real(1), real(0)
    w00 = (one - a) * (one - b) if behind_depth[r, c] >= depth else none
    w01 = (one - a) * b if behind_depth[r, c1] >= depth else none
    w10 = a * (one - b) if behind_depth[r1, c] >= depth else none
    w11 = a * b if behind_depth[r1, c1] >= depth else none
    total = w00 + w01 + w10 + w11
    if total <= real(1e-3):
        return own
    f, per = behind_colour, one / total
    return (
        (w00 * f[0, r, c] + w01 * f[0, r, c1] + w10 * f[0, r1, c] + w11 * f[0, r1, c1]) * per,
        (w00 * f[1, r, c] + w01 * f[1, r, c1] + w10 * f[1, r1, c] + w11 * f[1, r1, c1]) * per,
        (w00 * f[2, r, c] + w01 * f[2, r, c1] + w10 * f[2, r1, c] + w11 * f[2, r1, c1]) * per,
    )


@scalar_lookup
def body(row, column, screen_value, screen_map, optics):
    """Return the liquid's own colour: that of its value on the map, or the same everywhere."""
    if optics.mapped == 0:
        return optics.body_red, optics.body_green, optics.body_blue
    real = screen_map.dtype.type
    value, weight = doubled(screen_value[0], row, column), doubled(screen_value[1], row, column)
    last = screen_map.shape[1] - 1
    at = min(max(value / max(weight, real(1e-4)), real(0)), real(1)) * real(last)
    k = min(int(at), max(last - 1, 0))
    t, m = at - real(k), min(k + 1, last)
    return (
        screen_map[0, k] + t * (screen_map[0, m] - screen_map[0, k]),
        screen_map[1, k] + t * (screen_map[1, m] - screen_map[1, k]),
        screen_map[2, k] + t * (screen_map[2, m] - screen_map[2, k]),
    )


@scalar
def lit(u, v, nx, ny, nz, optics):
    """Return (F, colour of the sky mirrored, highlight, light) of a surface seen along (u, v, 1)."""
    real = type(u)
    size = real(1) / math.sqrt(u * u + v * v + real(1))
    x, y, z = u * size, v * size, size
    facing = -(x * nx + y * ny + z * nz)
    mirrored = sky(x + real(2) * facing * nx, y + real(2) * facing * ny, z + real(2) * facing * nz, optics)
    hx, hy, hz = optics.sun_x - x, optics.sun_y - y, optics.sun_z - z
    shine = max((nx * hx + ny * hy + nz * hz) / math.sqrt(hx * hx + hy * hy + hz * hz), real(0))
    for _ in range(optics.doublings):
        shine *= shine
    sun = max(nx * optics.sun_x + ny * optics.sun_y + nz * optics.sun_z, real(0))
    return schlick(facing, optics.fresnel), mirrored, optics.shine * shine, optics.ambient + (real(1) - optics.ambient) * sun


@scalar
def mixed(own, back, mirrored, absorb, length, light, F, shine):
    """Return one channel of the colour."""
    one = type(length)(1)
    through = decay(absorb * length)
    return (own * light * (one - through) + back * through) * (one - F) + mirrored * F + shine
