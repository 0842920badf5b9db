"""Formulas of one APIC particle. Slime spec 2.1, 2.3, 2.13. Symmetric tensors: xx, yy, zz, xy, xz, yz."""

from melt._compile import scalar
from melt.physics.polar import eigen


@scalar
def pseudo_inverse(D, rank):
    """Return the pseudo-inverse of a symmetric tensor (6) without the eigenvalues below ``rank``.

    All eigenvalues are at least 4 det/tr^2. If that is clear of the threshold the inverse is that of Cramer;
    only sheets, threads and the plane need eigenvalues.
    """
    real = type(D[0])
    zero = real(0)
    trace = D[0] + D[1] + D[2]
    if not trace > zero:
        return zero, zero, zero, zero, zero, zero
    f = real(1) / trace
    xx, yy, zz, xy, xz, yz = D[0] * f, D[1] * f, D[2] * f, D[3] * f, D[4] * f, D[5] * f
    m_xx, m_xy, m_xz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    det = xx * m_xx + xy * m_xy + xz * m_xz
    if real(2) * det > f * rank:
        g = f / det
        return g * m_xx, g * (xx * zz - xz * xz), g * (xx * yy - xy * xy), g * m_xy, g * m_xz, g * (xy * xz - xx * yz)
    a, v0, v1, v2 = eigen((xx, yy, zz, xy, xz, yz))
    f0 = f / a[0] if a[0] >= f * rank else zero
    f1 = f / a[1] if a[1] >= f * rank else zero
    f2 = f / a[2] if a[2] >= f * rank else zero
    return (
        f0 * v0[0] * v0[0] + f1 * v1[0] * v1[0] + f2 * v2[0] * v2[0],
        f0 * v0[1] * v0[1] + f1 * v1[1] * v1[1] + f2 * v2[1] * v2[1],
        f0 * v0[2] * v0[2] + f1 * v1[2] * v1[2] + f2 * v2[2] * v2[2],
        f0 * v0[0] * v0[1] + f1 * v1[0] * v1[1] + f2 * v2[0] * v2[1],
        f0 * v0[0] * v0[2] + f1 * v1[0] * v1[2] + f2 * v2[0] * v2[2],
        f0 * v0[1] * v0[2] + f1 * v1[1] * v1[2] + f2 * v2[1] * v2[2],
    )


@scalar
def about_centre(S, m, D):
    """Return the centre m/S, the second moment about it (6), and whether too few of its digits are left.

    The sums are about another point, whose distance from the centre costs digits where nodes spread little.
    """
    real = type(S)
    f = real(1) / S
    x, y, z = f * m[0], f * m[1], f * m[2]
    moment = f * D[0] - x * x, f * D[1] - y * y, f * D[2] - z * z, f * D[3] - x * y, f * D[4] - x * z, f * D[5] - y * z
    trace = moment[0] + moment[1] + moment[2]
    det = moment[0] * (moment[1] * moment[2] - moment[5] * moment[5])
    det -= moment[3] * (moment[3] * moment[2] - moment[4] * moment[5])
    det += moment[4] * (moment[3] * moment[5] - moment[4] * moment[1])
    return (x, y, z), moment, (x * x + y * y + z * z) * trace * trace > real(4) * det


@scalar
def _product(A, B):
    """Return the product of two 3x3 matrices, row by row."""
    return (
        A[0] * B[0] + A[1] * B[3] + A[2] * B[6], A[0] * B[1] + A[1] * B[4] + A[2] * B[7], A[0] * B[2] + A[1] * B[5] + A[2] * B[8],
        A[3] * B[0] + A[4] * B[3] + A[5] * B[6], A[3] * B[1] + A[4] * B[4] + A[5] * B[7], A[3] * B[2] + A[4] * B[5] + A[5] * B[8],
        A[6] * B[0] + A[7] * B[3] + A[8] * B[6], A[6] * B[1] + A[7] * B[4] + A[8] * B[7], A[6] * B[2] + A[7] * B[5] + A[8] * B[8],
    )


@scalar
def deformation(C, dt):
    """Return F = (I - dt C/2)^-1 (I + dt C/2) = 2 (I - dt C/2)^-1 - I of an affine velocity (9), row by row."""
    real = type(dt)
    f, one = real(-0.5) * dt, real(1)
    a, b, c = one + f * C[0], f * C[1], f * C[2]
    d, e, g = f * C[3], one + f * C[4], f * C[5]
    h, k, m = f * C[6], f * C[7], one + f * C[8]
    A, B, D = e * m - g * k, g * h - d * m, d * k - e * h
    s = real(2) / (a * A + b * B + c * D)
    return (
        s * A - one, s * (c * k - b * m), s * (b * g - c * e),
        s * B, s * (a * m - c * h) - one, s * (c * d - a * g),
        s * D, s * (b * h - a * k), s * (a * e - b * d) - one,
    )


@scalar
def relaxed(C, b, dt, elastic):
    """Return the conformation tensor (6) after dt of stretching by the affine velocity C (9) and of relaxation."""
    real = type(dt)
    F = deformation(C, dt)
    T = _product(F, (b[0], b[3], b[4], b[3], b[1], b[5], b[4], b[5], b[2]))
    rate = dt / elastic.relaxation
    s = real(1) / (real(1) + rate)
    return (
        s * (T[0] * F[0] + T[1] * F[1] + T[2] * F[2] + rate),
        s * (T[3] * F[3] + T[4] * F[4] + T[5] * F[5] + rate),
        s * (T[6] * F[6] + T[7] * F[7] + T[8] * F[8] + rate),
        s * (T[0] * F[3] + T[1] * F[4] + T[2] * F[5]),
        s * (T[0] * F[6] + T[1] * F[7] + T[2] * F[8]),
        s * (T[3] * F[6] + T[4] * F[7] + T[5] * F[8]),
    )


@scalar
def pull(b, D, factor):
    """Return factor (b - I) D (9, row by row) of two symmetric tensors: the force on a node is minus this times its distance."""
    one = type(factor)(1)
    xx, yy, zz = factor * (b[0] - one), factor * (b[1] - one), factor * (b[2] - one)
    xy, xz, yz = factor * b[3], factor * b[4], factor * b[5]
    return _product((xx, xy, xz, xy, yy, yz, xz, yz, zz), (D[0], D[3], D[4], D[3], D[1], D[5], D[4], D[5], D[2]))
