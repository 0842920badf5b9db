"""Scalar formulas of the screen-space renderer. Flood spec 5."""

import math

from melt._compile import scalar


@scalar
def decay(x):
    """exp(-x) for x >= 0 by a series of exp(-x/32), squared five times.

    Branch-free, so that loops over pixels vectorise, which the library's exp prevents. Error below 5e-9 (float64) and
    1e-6 (float32) of 1; arguments above 32 count as 32.
    """
    real = type(x)
    y = min(x, real(32)) * real(1 / 32)
    term = real(1 / 6) - y * (real(1 / 24) - y * real(1 / 120))
    term = real(1) - y * (real(1) - y * (real(0.5) - y * term))
    term *= term
    term *= term
    term *= term
    term *= term
    return term * term


@scalar
def pierce(a, b, p, q, narrow):
    """Return (share, 1/|d|^2) of the ray d = (p + a, q + b, 1) and a sphere in the direction (p, q, 1).

    ``share`` is 1 - (distance of the ray from the centre / radius)^2: the ray misses the sphere where it is not above
    0. ``narrow`` is (depth of the centre / radius)^2. The distance comes from the cross product of ray and centre,
    in which nothing cancels however far away it is.
    """
    one = type(narrow)(1)
    u, v, c = p + a, q + b, a * q - b * p
    inverse = one / (u * u + v * v + one)
    return one - narrow * (a * a + b * b + c * c) * inverse, inverse


@scalar
def entry(a, b, p, q, z, radius, share, inverse):
    """Return the depth at which the ray of `pierce` enters the sphere; ``share`` must not be below 0."""
    return z * (type(z)(1) + p * (p + a) + q * (q + b)) * inverse - radius * math.sqrt(share * inverse)


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
