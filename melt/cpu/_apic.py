"""Sums over the nodes near an APIC particle, and over the APIC particles near a node.

Particles come in cell order, so those of a cell share their candidates: what lies in the cells around is copied once
to a buffer, with everything of a partner that does not depend on the pair already combined, and then read in one long
loop without branches (the weight is 0 beyond the support). Buffers end with entries that count nothing, up to a whole
number of vectors.
"""

import math

import numpy as np

from melt._compile import cpu_helper
from melt.physics.period import wrap
from melt.physics.phases import LIQUID
from melt.physics.smoothing import W

PAD = 32


@cpu_helper
def copy_places(position, phase, row, rows, place, number):
    """Copy the places of liquid particles of the rows to ``place``, their numbers to ``number``; return how many."""
    slot = np.uint64(0)
    for k in range(rows):
        for j in range(np.uint64(row[k, 0]), np.uint64(row[k, 1])):
            place[0, slot], place[1, slot], place[2, slot] = position[0, j], position[1, j], position[2, j]
            number[slot] = np.int32(j)
            slot += np.uint64(phase[j] == LIQUID)
    return np.int64(slot)


@cpu_helper
def pad(place, value, count):
    """Fill up to a whole number of vectors with entries of value 0; return where the buffer ends."""
    stop = (count + PAD - 1) // PAD * PAD
    for k in range(np.uint64(count), np.uint64(stop)):
        for a in range(3):  # any finite place
            place[a, k] = place[a, np.uint64(0)]
        for a in range(value.shape[0]):
            value[a, k] = value.dtype.type(0)
    return stop


@cpu_helper
def moments(place, value, stop, x_p, y_p, z_p, c, period, apic):
    """Return sums of W: alone, times e = x_I - x_p - c (3), times e e^T (6); ``value`` (1, ...) is 1 where a node counts."""
    real = type(apic.support)
    X, Y, Z, counts = place[0], place[1], place[2], value[0]
    s = mx = my = mz = xx = yy = zz = xy = xz = yz = real(0)
    for k in range(np.uint64(stop)):
        x = real(wrap(X[k] - x_p, period.length_x, period.inverse_x))
        y = real(wrap(Y[k] - y_p, period.length_y, period.inverse_y))
        z = real(wrap(Z[k] - z_p, period.length_z, period.inverse_z))
        w = counts[k] * W(math.sqrt(x * x + y * y + z * z), apic)
        x, y, z = x - c[0], y - c[1], z - c[2]
        wx, wy, wz = w * x, w * y, w * z
        s += w
        mx, my, mz = mx + wx, my + wy, mz + wz
        xx, yy, zz = xx + wx * x, yy + wy * y, zz + wz * z
        xy, xz, yz = xy + wx * y, xz + wx * z, yz + wy * z
    return s, (mx, my, mz), (xx, yy, zz, xy, xz, yz)


@cpu_helper
def velocity_sums(place, value, stop, x_p, y_p, z_p, c, period, apic):
    """Return sums of W times value 3 to 5, and of W times value 0 to 2 times (d - c)^T (9, row by row)."""
    real = type(apic.support)
    X, Y, Z = place[0], place[1], place[2]
    U, V, Q, F, G, H = value[0], value[1], value[2], value[3], value[4], value[5]
    f = g = h = xx = xy = xz = yx = yy = yz = zx = zy = zz = real(0)
    for k in range(np.uint64(stop)):
        x = real(wrap(X[k] - x_p, period.length_x, period.inverse_x))
        y = real(wrap(Y[k] - y_p, period.length_y, period.inverse_y))
        z = real(wrap(Z[k] - z_p, period.length_z, period.inverse_z))
        w = W(math.sqrt(x * x + y * y + z * z), apic)
        f, g, h = f + w * F[k], g + w * G[k], h + w * H[k]
        x, y, z = w * (x - c[0]), w * (y - c[1]), w * (z - c[2])
        xx, xy, xz = xx + U[k] * x, xy + U[k] * y, xz + U[k] * z
        yx, yy, yz = yx + V[k] * x, yy + V[k] * y, yz + V[k] * z
        zx, zy, zz = zx + Q[k] * x, zy + Q[k] * y, zz + Q[k] * z
    return (f, g, h), (xx, xy, xz, yx, yy, yz, zx, zy, zz)


@cpu_helper
def affine_sums(place, value, stop, x_i, y_i, z_i, period, apic):
    """Return sums of W a and W (u + A d), d = x_I - x_p; ``value`` (13, ...) is a, u (3) and A (9, row by row)."""
    real = type(apic.support)
    X, Y, Z, M, U, V, Q = place[0], place[1], place[2], value[0], value[1], value[2], value[3]
    A, B, C, D, E, F, G, H, K = value[4], value[5], value[6], value[7], value[8], value[9], value[10], value[11], value[12]
    m = u = v = q = real(0)
    for k in range(np.uint64(stop)):
        x = real(wrap(x_i - X[k], period.length_x, period.inverse_x))
        y = real(wrap(y_i - Y[k], period.length_y, period.inverse_y))
        z = real(wrap(z_i - Z[k], period.length_z, period.inverse_z))
        w = W(math.sqrt(x * x + y * y + z * z), apic)
        m += w * M[k]
        u += w * (U[k] + A[k] * x + B[k] * y + C[k] * z)
        v += w * (V[k] + D[k] * x + E[k] * y + F[k] * z)
        q += w * (Q[k] + G[k] * x + H[k] * y + K[k] * z)
    return m, u, v, q


@cpu_helper
def less_turn(A, B, C, apic_centre, first, target, slot, count):
    """Take away what the affine velocity (A, B, C) makes of the centre."""
    first, slot = np.uint64(first), np.uint64(slot)
    x, y, z = apic_centre[0], apic_centre[1], apic_centre[2]
    for k in range(np.uint64(count)):
        target[slot + k] -= A[slot + k] * x[first + k] + B[slot + k] * y[first + k] + C[slot + k] * z[first + k]
