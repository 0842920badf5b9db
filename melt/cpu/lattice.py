"""CPU twin of `melt.reference.lattice`.

Slots without a member (-1) read the region's own site instead: their separation is zero and
their mass share is masked, so the loop over slots has no branch and vectorises. Rest vectors
are voxel offsets times the spacing, the same for every region: tables made once per chunk.
"""

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.polar import rotation
from melt.physics.quaternion import rotate

CHUNKS = 64


@cpu_helper
def _offsets(lattice):
    """Return the rest vectors of the slots, (3, slots) [m]."""
    w, dx = lattice.width, lattice.spacing
    side = 2 * w + 1
    table = np.empty((3, side * side * side), np.asarray(dx).dtype)
    for k in range(table.shape[1]):
        table[0, k] = (k % side - w) * dx
        table[1, k] = (k // side % side - w) * dx
        table[2, k] = (k // (side * side) - w) * dx
    return table


@cpu_stage
def region_share(mass, site_particle, site_region_count, region_share):
    """See `melt.reference.lattice.region_share`."""
    real = mass.dtype.type
    for s in prange(site_particle.shape[0]):
        n = site_region_count[s]
        region_share[s] = mass[site_particle[s]] / real(n) if n > 0 else real(0)


@cpu_stage
def region_rest(site_region, site_region_count, site_dirty, region_share, lattice, region_mass, region_rest):
    """See `melt.reference.lattice.region_rest`."""
    real = region_share.dtype.type
    count = site_region_count.shape[0]
    slots = np.uint64(site_region.shape[1])
    for chunk in prange(CHUNKS):
        rest = _offsets(lattice)
        for s in range(count * chunk // CHUNKS, count * (chunk + 1) // CHUNKS):
            if not site_dirty[s] & 2:
                continue
            total, x, y, z = real(0), real(0), real(0), real(0)
            if site_region_count[s] > 0:
                for k in range(slots):
                    member = site_region[s, k]
                    j = np.uint64(member if member >= 0 else s)
                    m = region_share[j] if member >= 0 else real(0)
                    total += m
                    x += m * rest[0, k]
                    y += m * rest[1, k]
                    z += m * rest[2, k]
                x, y, z = x / total, y / total, z / total
            region_mass[s] = total
            region_rest[0, s], region_rest[1, s], region_rest[2, s] = x, y, z


@cpu_stage
def region_match(
    position, site_particle, site_region, site_region_count, region_share, region_mass, region_rest,
    lattice, site_position, region_rotation, region_mean, region_shift,
):
    """See `melt.reference.lattice.region_match`."""
    real = region_share.dtype.type
    wide = position.dtype.type  # sums are as wide as positions (precision `mixed`)
    count = site_region_count.shape[0]
    slots = np.uint64(site_region.shape[1])
    for s in prange(count):
        p = site_particle[s]
        for a in range(3):
            site_position[a, s] = position[a, p] if p >= 0 else wide(0)
    for chunk in prange(CHUNKS):
        rest = _offsets(lattice)
        for s in range(count * chunk // CHUNKS, count * (chunk + 1) // CHUNKS):
            if site_region_count[s] == 0:
                for a in range(3):
                    region_mean[a, s] = region_shift[a, s] = real(0)
                continue
            x_s, y_s, z_s = site_position[0, s], site_position[1, s], site_position[2, s]
            X_s, Y_s, Z_s = region_rest[0, s], region_rest[1, s], region_rest[2, s]
            ex, ey, ez = wide(0), wide(0), wide(0)
            cx, cy, cz = wide(0), wide(0), wide(0)
            a0, a1, a2 = wide(0), wide(0), wide(0)
            a3, a4, a5 = wide(0), wide(0), wide(0)
            a6, a7, a8 = wide(0), wide(0), wide(0)
            for k in range(slots):
                member = site_region[s, k]
                j = np.uint64(member if member >= 0 else s)
                m = region_share[j] if member >= 0 else real(0)
                x = real(site_position[0, j] - x_s)
                y = real(site_position[1, j] - y_s)
                z = real(site_position[2, j] - z_s)
                ex += x
                ey += y
                ez += z
                x, y, z = m * x, m * y, m * z
                cx += x
                cy += y
                cz += z
                X, Y, Z = rest[0, k] - X_s, rest[1, k] - Y_s, rest[2, k] - Z_s
                a0 += x * X
                a1 += x * Y
                a2 += x * Z
                a3 += y * X
                a4 += y * Y
                a5 += y * Z
                a6 += z * X
                a7 += z * Y
                a8 += z * Z
            n, M = wide(site_region_count[s]), wide(region_mass[s])
            region_mean[0, s], region_mean[1, s], region_mean[2, s] = ex / n, ey / n, ez / n
            q = rotation(
                (real(a0), real(a1), real(a2), real(a3), real(a4), real(a5), real(a6), real(a7), real(a8)),
                (region_rotation[0, s], region_rotation[1, s], region_rotation[2, s], region_rotation[3, s]),
                lattice,
            )
            for a in range(4):
                region_rotation[a, s] = q[a]
            r = rotate(q[0], q[1], q[2], q[3], X_s, Y_s, Z_s)
            region_shift[0, s] = real(cx / M) - r[0]
            region_shift[1, s] = real(cy / M) - r[1]
            region_shift[2, s] = real(cz / M) - r[2]


@cpu_stage
def goal(site_region, site_region_count, region_rotation, region_mean, region_shift, lattice, goal):
    """See `melt.reference.lattice.goal`."""
    real = region_shift.dtype.type
    one, two = real(1), real(2)
    count = site_region_count.shape[0]
    slots = np.uint64(site_region.shape[1])
    for chunk in prange(CHUNKS):
        rest = _offsets(lattice)
        for s in range(count * chunk // CHUNKS, count * (chunk + 1) // CHUNKS):
            if site_region_count[s] == 0:
                goal[0, s] = goal[1, s] = goal[2, s] = real(0)
                continue
            gx, gy, gz = real(0), real(0), real(0)
            for k in range(slots):
                member = site_region[s, k]
                j = np.uint64(member if member >= 0 else s)
                here = one if member >= 0 else real(0)
                w, x = region_rotation[0, j], region_rotation[1, j]
                y, z = region_rotation[2, j], region_rotation[3, j]
                # the region of site j sees this site at minus the offset
                X, Y, Z = -rest[0, k], -rest[1, k], -rest[2, k]
                p = y * Z - z * Y + w * X
                q = z * X - x * Z + w * Y
                r = x * Y - y * X + w * Z
                gx += here * (X + two * (y * r - z * q) + region_shift[0, j])
                gy += here * (Y + two * (z * p - x * r) + region_shift[1, j])
                gz += here * (Z + two * (x * q - y * p) + region_shift[2, j])
            n = real(site_region_count[s])
            goal[0, s] = gx / n + region_mean[0, s]
            goal[1, s] = gy / n + region_mean[1, s]
            goal[2, s] = gz / n + region_mean[2, s]
