"""Quaternions (w, x, y, z) of rotations, kept normalised with w >= 0 so that backends compare."""

import math

from melt._compile import scalar


@scalar
def canonical(w, x, y, z):
    """Return the unit quaternion of the same rotation with w >= 0 (first component that counts)."""
    scale = type(w)(1) / math.sqrt(w * w + x * x + y * y + z * z)
    if w < 0 or (w == 0 and (x < 0 or (x == 0 and (y < 0 or (y == 0 and z < 0))))):
        scale = -scale
    return w * scale, x * scale, y * scale, z * scale


@scalar
def multiply(aw, ax, ay, az, bw, bx, by, bz):
    """Return the product a b: the rotation b followed by a."""
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


@scalar
def matrix(w, x, y, z):
    """Return the rotation matrix, row by row, of a unit quaternion."""
    one, two = type(w)(1), type(w)(2)
    return (
        one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y),
        two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x),
        two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y),
    )


@scalar
def rotate(w, x, y, z, a, b, c):
    """Return the vector (a, b, c) turned by a unit quaternion: v + 2 u x (u x v + w v)."""
    two = type(w)(2)
    p = y * c - z * b + w * a
    q = z * a - x * c + w * b
    r = x * b - y * a + w * c
    return a + two * (y * r - z * q), b + two * (z * p - x * r), c + two * (x * q - y * p)


@scalar
def from_matrix(a, b, c, d, e, f, g, h, i):
    """Return the canonical quaternion of the rotation matrix with rows abc, def, ghi (Shepperd)."""
    one = type(a)(1)
    if a + e + i >= 0:
        return canonical(one + a + e + i, h - f, c - g, d - b)
    if a >= e and a >= i:
        return canonical(h - f, one + a - e - i, b + d, c + g)
    if e >= i:
        return canonical(c - g, b + d, one - a + e - i, f + h)
    return canonical(d - b, c + g, f + h, one - a - e + i)
