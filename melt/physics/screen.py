"""Scalar formulas of the screen-space renderer. Flood spec 5."""

import math

from melt._compile import scalar


@scalar
def decay(x):
    """exp(-x) for x >= 0 by a series of exp(-x/64), squared six times.

    Branch-free, so that loops over pixels vectorise, which the library's exp prevents. Error below 1e-13 (float64)
    and 4e-7 (float32) of 1; arguments above 32 count as 32.
    """
    real = type(x)
    y = min(x, real(32)) * real(1 / 64)
    term = real(1) - y * real(1 / 9)
    term = real(1) - y * real(1 / 8) * term
    term = real(1) - y * real(1 / 7) * term
    term = real(1) - y * real(1 / 6) * term
    term = real(1) - y * real(1 / 5) * term
    term = real(1) - y * real(1 / 4) * term
    term = real(1) - y * real(1 / 3) * term
    term = real(1) - y * real(1 / 2) * term
    term = real(1) - y * term
    term *= term
    term *= term
    term *= term
    term *= term
    term *= term
    return term * term


@scalar
def pierce(a, b, p, q, z, radius):
    """Return (depth of entry, length inside, share) of the ray (p + a, q + b, 1) through a sphere around z (p, q, 1).

    ``share`` is 1 - (distance of the ray from the centre / radius)^2: the sphere is missed where it is not above 0.
    The distance comes from the cross product of ray and centre, in which nothing cancels however far away it is.
    """
    one = type(z)(1)
    u, v, c = p + a, q + b, a * q - b * p
    inverse = one / (u * u + v * v + one)
    share = one - z * z * (a * a + b * b + c * c) * inverse / (radius * radius)
    rest = max(share, type(z)(0))
    half = radius * math.sqrt(rest * inverse)
    depth = z * (one + p * u + q * v) * inverse - half
    return depth, (radius + radius) * math.sqrt(rest), share


@scalar
def window(depth, size, focal, smallest, largest):
    """Return 1/(2 sigma_s^2) [1/px^2] of the filter at a depth: sigma_s = clamp(f sigma_w/D, smallest, largest)."""
    real = type(depth)
    sigma = min(max(focal * size / depth, smallest), largest)
    return real(0.5) / (sigma * sigma)


@scalar
def sky(x, y, z, optics):
    """Return the colour (red, green, blue) that is seen in the direction (x, y, z) of the camera frame."""
    real = type(x)
    rise = x * optics.up_x + y * optics.up_y + z * optics.up_z
    up = min(max(rise * real(1.6), real(0)), real(1))
    down = min(max(rise * real(-4), real(0)), real(1))
    level = real(1) - up - down  # one of both is 0
    return (
        level * optics.horizon_red + up * optics.zenith_red + down * optics.nadir_red,
        level * optics.horizon_green + up * optics.zenith_green + down * optics.nadir_green,
        level * optics.horizon_blue + up * optics.zenith_blue + down * optics.nadir_blue,
    )


@scalar
def schlick(cosine, fresnel):
    """F = F0 + (1 - F0) (1 - n.v)^5."""
    real = type(cosine)
    left = min(max(real(1) - cosine, real(0)), real(1))
    square = left * left
    return fresnel + (real(1) - fresnel) * square * square * left
