r"""Rotation factor of a 3x3 matrix, three ways. Melting spec 2.7.

All take A = Sum m (x - c)(X - c0)^T row by row and the previous rotation q, and return the
rotation R (quaternion, w >= 0) that maximises tr(R^T A): R A^T is symmetric, det R = +1,
also for reflections (the direction of the smallest singular value gives way).

With singular values s1 >= s2 >= |s3|, s3 carrying the sign of det A, the largest eigenvalue of
Horn's matrix has the gap 2 (s2 + s3). Where that vanishes (collinear or coincident points,
mirror images of symmetric bodies) many rotations are equally good. All routines then return
the one nearest to the previous rotation: a rod does not spin at random, a single particle
keeps its rotation, and the routines agree.
"""

import math

from melt._compile import scalar
from melt.params import ROTATION_HORN, ROTATION_SVD
from melt.physics.quaternion import canonical, from_matrix, matrix, multiply

#: Singular values below this share of the largest count as zero (spec 3.3).
RANK = 1e-6


@scalar
def _givens(app, aqq, apq):
    """Return cosine, sine and tangent of the Jacobi rotation that clears a_pq."""
    real = type(app)
    if apq == 0:
        return real(1), real(0), real(0)
    theta = (aqq - app) / (real(2) * apq)
    t = real(1) / (abs(theta) + math.sqrt(theta * theta + real(1)))
    t = -t if theta < 0 else t
    c = real(1) / math.sqrt(t * t + real(1))
    return c, t * c, t


@scalar
def _turn(p, q, c, s):
    return c * p - s * q, s * p + c * q


@scalar
def _turn4(p, q, c, s):
    return (
        (c * p[0] - s * q[0], c * p[1] - s * q[1], c * p[2] - s * q[2], c * p[3] - s * q[3]),
        (s * p[0] + c * q[0], s * p[1] + c * q[1], s * p[2] + c * q[2], s * p[3] + c * q[3]),
    )


@scalar
def _add_if(near, total, v, q):
    """Return ``total`` plus the projection of q on the unit vector v, if ``near``."""
    if not near:
        return total
    f = v[0] * q[0] + v[1] * q[1] + v[2] * q[2] + v[3] * q[3]
    return total[0] + f * v[0], total[1] + f * v[1], total[2] + f * v[2], total[3] + f * v[3]


@scalar
def horn(A, q):
    """Return R as the eigenvector of Horn's symmetric 4x4 matrix, by cyclic Jacobi: any rank.

    ``A``: 9 numbers, row by row; ``q``: previous rotation, 4 numbers.
    """
    real = type(A[0])
    one, zero = real(1), real(0)
    # N of Horn 1987 with S_ab = Sum X_a x_b = A_ba
    a00, a11 = A[0] + A[4] + A[8], A[0] - A[4] - A[8]
    a22, a33 = -A[0] + A[4] - A[8], -A[0] - A[4] + A[8]
    a01, a02, a03 = A[7] - A[5], A[2] - A[6], A[3] - A[1]
    a12, a13, a23 = A[1] + A[3], A[2] + A[6], A[5] + A[7]
    scale = abs(a00) + abs(a11) + abs(a22) + abs(a33) + abs(a01) + abs(a02) + abs(a03)
    scale += abs(a12) + abs(a13) + abs(a23)
    v0, v1 = (one, zero, zero, zero), (zero, one, zero, zero)
    v2, v3 = (zero, zero, one, zero), (zero, zero, zero, one)
    for _ in range(12):
        off = abs(a01) + abs(a02) + abs(a03) + abs(a12) + abs(a13) + abs(a23)
        if not scale + real(0.1) * off > scale:
            break
        c, s, t = _givens(a00, a11, a01)
        a00, a11, a01 = a00 - t * a01, a11 + t * a01, zero
        (a02, a12), (a03, a13) = _turn(a02, a12, c, s), _turn(a03, a13, c, s)
        v0, v1 = _turn4(v0, v1, c, s)
        c, s, t = _givens(a22, a33, a23)
        a22, a33, a23 = a22 - t * a23, a33 + t * a23, zero
        (a02, a03), (a12, a13) = _turn(a02, a03, c, s), _turn(a12, a13, c, s)
        v2, v3 = _turn4(v2, v3, c, s)
        c, s, t = _givens(a00, a22, a02)
        a00, a22, a02 = a00 - t * a02, a22 + t * a02, zero
        (a01, a12), (a03, a23) = _turn(a01, a12, c, s), _turn(a03, a23, c, s)
        v0, v2 = _turn4(v0, v2, c, s)
        c, s, t = _givens(a11, a33, a13)
        a11, a33, a13 = a11 - t * a13, a33 + t * a13, zero
        (a01, a03), (a12, a23) = _turn(a01, a03, c, s), _turn(a12, a23, c, s)
        v1, v3 = _turn4(v1, v3, c, s)
        c, s, t = _givens(a00, a33, a03)
        a00, a33, a03 = a00 - t * a03, a33 + t * a03, zero
        (a01, a13), (a02, a23) = _turn(a01, a13, c, s), _turn(a02, a23, c, s)
        v0, v3 = _turn4(v0, v3, c, s)
        c, s, t = _givens(a11, a22, a12)
        a11, a22, a12 = a11 - t * a12, a22 + t * a12, zero
        (a01, a02), (a13, a23) = _turn(a01, a02, c, s), _turn(a13, a23, c, s)
        v1, v2 = _turn4(v1, v2, c, s)
    top = max(max(a00, a11), max(a22, a33))
    level = top - real(2 * RANK) * max(abs(min(min(a00, a11), min(a22, a33))), abs(top))
    n0, n1, n2, n3 = a00 >= level, a11 >= level, a22 >= level, a33 >= level
    best = v0 if a00 == top else (v1 if a11 == top else (v2 if a22 == top else v3))
    if int(n0) + int(n1) + int(n2) + int(n3) > 1:
        total = _add_if(n0, (zero, zero, zero, zero), v0, q)
        total = _add_if(n1, total, v1, q)
        total = _add_if(n2, total, v2, q)
        total = _add_if(n3, total, v3, q)
        size = total[0] * total[0] + total[1] * total[1] + total[2] * total[2] + total[3] * total[3]
        if size > real(1e-6):
            best = total
    return canonical(best[0], best[1], best[2], best[3])


@scalar
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@scalar
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@scalar
def _turn3(p, q, c, s):
    return (
        (c * p[0] - s * q[0], c * p[1] - s * q[1], c * p[2] - s * q[2]),
        (s * p[0] + c * q[0], s * p[1] + c * q[1], s * p[2] + c * q[2]),
    )


@scalar
def svd(A, q):
    """Return R = U diag(1, 1, det U V^T) V^T, by one-sided Jacobi on the columns of A."""
    real = type(A[0])
    one, zero = real(1), real(0)
    b0, b1, b2 = (A[0], A[3], A[6]), (A[1], A[4], A[7]), (A[2], A[5], A[8])
    v0, v1, v2 = (one, zero, zero), (zero, one, zero), (zero, zero, one)
    for _ in range(16):
        c, s, _t = _givens(_dot(b0, b0), _dot(b1, b1), _dot(b0, b1))
        b0, b1 = _turn3(b0, b1, c, s)
        v0, v1 = _turn3(v0, v1, c, s)
        most = abs(s)
        c, s, _t = _givens(_dot(b0, b0), _dot(b2, b2), _dot(b0, b2))
        b0, b2 = _turn3(b0, b2, c, s)
        v0, v2 = _turn3(v0, v2, c, s)
        most = max(most, abs(s))
        c, s, _t = _givens(_dot(b1, b1), _dot(b2, b2), _dot(b1, b2))
        b1, b2 = _turn3(b1, b2, c, s)
        v1, v2 = _turn3(v1, v2, c, s)
        if not one + max(most, abs(s)) > one:
            break
    if _dot(b0, b0) < _dot(b1, b1):
        b0, b1, v0, v1 = b1, b0, v1, v0
    if _dot(b0, b0) < _dot(b2, b2):
        b0, b2, v0, v2 = b2, b0, v2, v0
    if _dot(b1, b1) < _dot(b2, b2):
        b1, b2, v1, v2 = b2, b1, v2, v1
    s0, s1 = math.sqrt(_dot(b0, b0)), math.sqrt(_dot(b1, b1))
    if s1 <= real(RANK) * s0:
        return horn(A, q)
    u0 = (b0[0] / s0, b0[1] / s0, b0[2] / s0)
    u1 = (b1[0] / s1, b1[1] / s1, b1[2] / s1)
    u2, w2 = _cross(u0, u1), _cross(v0, v1)  # the third pair turns with the others: det R = +1
    s2 = _dot(b2, u2) * (one if _dot(v2, w2) > 0 else -one)
    if s1 + s2 <= real(RANK) * s0:
        return horn(A, q)
    return from_matrix(
        u0[0] * v0[0] + u1[0] * v1[0] + u2[0] * w2[0],
        u0[0] * v0[1] + u1[0] * v1[1] + u2[0] * w2[1],
        u0[0] * v0[2] + u1[0] * v1[2] + u2[0] * w2[2],
        u0[1] * v0[0] + u1[1] * v1[0] + u2[1] * w2[0],
        u0[1] * v0[1] + u1[1] * v1[1] + u2[1] * w2[1],
        u0[1] * v0[2] + u1[1] * v1[2] + u2[1] * w2[2],
        u0[2] * v0[0] + u1[2] * v1[0] + u2[2] * w2[0],
        u0[2] * v0[1] + u1[2] * v1[1] + u2[2] * w2[1],
        u0[2] * v0[2] + u1[2] * v1[2] + u2[2] * w2[2],
    )


@scalar
def iterative(A, q, tolerance, iterations):
    r"""Return R by Newton's method from the previous rotation; `horn` where that is not certain.

    With B = R^T A and S = (B + B^T)/2, a turn omega in the body frame that makes B symmetric
    solves (tr S I - S) omega = axial(B). The published iteration divides by tr S alone and
    converges linearly (factor 1/3 on a cube); this is quadratic: 2-3 steps from the last time
    step. The matrix tr S I - S is positive definite only at the maximum of tr(R^T A), so it
    certifies the result: 180-degree traps, reflections and undetermined axes go to `horn`.
    """
    real = type(A[0])
    w, x, y, z = q[0], q[1], q[2], q[3]
    for _ in range(iterations):
        r = matrix(w, x, y, z)
        b00, b01, b02 = (
            r[0] * A[0] + r[3] * A[3] + r[6] * A[6],
            r[0] * A[1] + r[3] * A[4] + r[6] * A[7],
            r[0] * A[2] + r[3] * A[5] + r[6] * A[8],
        )
        b10, b11, b12 = (
            r[1] * A[0] + r[4] * A[3] + r[7] * A[6],
            r[1] * A[1] + r[4] * A[4] + r[7] * A[7],
            r[1] * A[2] + r[4] * A[5] + r[7] * A[8],
        )
        b20, b21, b22 = (
            r[2] * A[0] + r[5] * A[3] + r[8] * A[6],
            r[2] * A[1] + r[5] * A[4] + r[8] * A[7],
            r[2] * A[2] + r[5] * A[5] + r[8] * A[8],
        )
        half = real(-0.5)
        h00, h11, h22 = b11 + b22, b00 + b22, b00 + b11
        h01, h02, h12 = half * (b01 + b10), half * (b02 + b20), half * (b12 + b21)
        m00, m01, m02 = h11 * h22 - h12 * h12, h02 * h12 - h01 * h22, h01 * h12 - h02 * h11
        m11, m12, m22 = h00 * h22 - h02 * h02, h01 * h02 - h00 * h12, h00 * h11 - h01 * h01
        det = h00 * m00 + h01 * m01 + h02 * m02
        trace = b00 + b11 + b22
        if not (h00 > 0 and m22 > 0 and det > real(2e-5) * trace * trace * trace and trace > 0):
            break
        ax, ay, az = b21 - b12, b02 - b20, b10 - b01
        ox = (m00 * ax + m01 * ay + m02 * az) / det
        oy = (m01 * ax + m11 * ay + m12 * az) / det
        oz = (m02 * ax + m12 * ay + m22 * az) / det
        size = ox * ox + oy * oy + oz * oz
        # tan(omega/2) ~ omega/2: third order, without trigonometry; a turn of at most a radian
        f = real(0.5) / math.sqrt(max(size, real(1)))
        p = multiply(w, x, y, z, real(1), f * ox, f * oy, f * oz)
        w, x, y, z = canonical(p[0], p[1], p[2], p[3])
        # the error that is left is about omega squared
        if size <= tolerance:
            return w, x, y, z
    return horn(A, q)


@scalar
def rotation(A, q, lattice):
    """Return R by the routine that ``lattice.rotation`` names; A is scaled to size 1 first."""
    real = type(A[0])
    size = abs(A[0]) + abs(A[1]) + abs(A[2]) + abs(A[3]) + abs(A[4]) + abs(A[5])
    size += abs(A[6]) + abs(A[7]) + abs(A[8])
    f = real(1) / size if size > 0 else real(1)
    B = (A[0] * f, A[1] * f, A[2] * f, A[3] * f, A[4] * f, A[5] * f, A[6] * f, A[7] * f, A[8] * f)
    if lattice.rotation == ROTATION_SVD:
        return svd(B, q)
    if lattice.rotation == ROTATION_HORN:
        return horn(B, q)
    return iterative(B, q, lattice.tolerance, lattice.iterations)


@scalar
def eigen(J):
    """Return the eigenvalues and the three eigenvectors of a symmetric 3x3 matrix (xx, yy, zz, xy, xz, yz), by cyclic Jacobi."""
    real = type(J[0])
    one, zero = real(1), real(0)
    a0, a1, a2, a01, a02, a12 = J[0], J[1], J[2], J[3], J[4], J[5]
    v0, v1, v2 = (one, zero, zero), (zero, one, zero), (zero, zero, one)
    scale = abs(a0) + abs(a1) + abs(a2)
    for _ in range(10):
        if not scale + real(0.1) * (abs(a01) + abs(a02) + abs(a12)) > scale:
            break
        c, s, t = _givens(a0, a1, a01)
        a0, a1, a01 = a0 - t * a01, a1 + t * a01, zero
        a02, a12 = _turn(a02, a12, c, s)
        v0, v1 = _turn3(v0, v1, c, s)
        c, s, t = _givens(a0, a2, a02)
        a0, a2, a02 = a0 - t * a02, a2 + t * a02, zero
        a01, a12 = _turn(a01, a12, c, s)
        v0, v2 = _turn3(v0, v2, c, s)
        c, s, t = _givens(a1, a2, a12)
        a1, a2, a12 = a1 - t * a12, a2 + t * a12, zero
        a01, a02 = _turn(a01, a02, c, s)
        v1, v2 = _turn3(v1, v2, c, s)
    return (a0, a1, a2), v0, v1, v2


@scalar
def solve_inertia(J, L):
    """Return omega = J^+ L for a symmetric positive 3x3 matrix (xx, yy, zz, xy, xz, yz).

    Axes with an eigenvalue below 1e-8 of the largest (1e-5 in float32, whose rounding hides
    smaller ones) get no spin.
    """
    real = type(J[0])
    one, zero = real(1), real(0)
    a, v0, v1, v2 = eigen(J)
    least = real(1e-8) * max(a[0], max(a[1], a[2]))
    if not one + real(1e-8) > one:
        least = real(1e-5) * max(a[0], max(a[1], a[2]))
    f0 = _dot(v0, L) / a[0] if a[0] > least else zero
    f1 = _dot(v1, L) / a[1] if a[1] > least else zero
    f2 = _dot(v2, L) / a[2] if a[2] > least else zero
    return (
        f0 * v0[0] + f1 * v1[0] + f2 * v2[0],
        f0 * v0[1] + f1 * v1[1] + f2 * v2[1],
        f0 * v0[2] + f1 * v1[2] + f2 * v2[2],
    )
