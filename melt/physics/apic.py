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
