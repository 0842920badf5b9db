"""Tables of the lattice reference: voxel offsets of slots, rotations by SVD."""

import numpy as np


def offsets(slots):
    """Return the voxel offsets of the slots, (slots, 3), x fastest; 27 links or (2w+1)^3 members."""
    side = round(slots ** (1 / 3))
    w = side // 2
    z, y, x = np.unravel_index(np.arange(slots), (side, side, side))
    return np.stack([x - w, y - w, z - w], axis=1)


def bonds(connect):
    """Return for each of the 27 offsets whether voxels at it bond: 6 faces, 18 with edges, 26 all."""
    steps = np.abs(offsets(27)).sum(axis=1)
    return steps <= {6: 1, 18: 2, 26: 3}[int(connect)]


def turn(q):
    """Return the rotation matrix of the quaternion (w, x, y, z)."""
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def horn_matrix(A):
    """Return Horn's symmetric 4x4 matrix: q^T N q = tr(R(q)^T A). Horn 1987."""
    N = np.empty((4, 4))
    N[0, 0] = np.trace(A)
    N[0, 1:] = N[1:, 0] = A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]
    N[1:, 1:] = A + A.T - np.trace(A) * np.eye(3)
    return N


def rotation(A, previous):
    """Return the quaternion, w >= 0, of R = U diag(1, 1, det U V^T) V^T. Melting spec 2.7 (a).

    Where the best rotation is not unique (s2 + s3 <= 1e-6 s1 with signed s3): of the best ones
    the nearest to ``previous``, i.e. its projection on the top eigenspace of Horn's matrix.
    """
    U, s, Vt = np.linalg.svd(A)
    sign = 1.0 if np.linalg.det(U @ Vt) > 0 else -1.0
    if s[1] + sign * s[2] > 1e-6 * s[0]:
        q = np.linalg.eigh(horn_matrix(U @ np.diag([1, 1, sign]) @ Vt))[1][:, -1]
    else:
        level, vectors = np.linalg.eigh(horn_matrix(A))
        top = vectors[:, level >= level[-1] - 2e-6 * s[0]]
        q = top @ (top.T @ previous)
        q = q if q @ q > 1e-6 else vectors[:, -1]
    q = q / np.linalg.norm(q)
    first = q[np.flatnonzero(np.abs(q) > 1e-15)[0]]
    return q if first > 0 else -q
