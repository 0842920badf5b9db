"""CUDA twin of `melt.reference.lattice`: one thread per region, slots in ascending order."""

from melt._compile import cuda, cuda_kernel
from melt.physics.polar import rotation
from melt.physics.quaternion import rotate


@cuda_kernel
def _region_share(mass, site_particle, site_region_count, region_share):
    s = cuda.grid(1)
    if s >= site_particle.shape[0]:
        return
    real = mass.dtype.type
    n = site_region_count[s]
    region_share[s] = mass[site_particle[s]] / real(n) if n > 0 else real(0)


def region_share(mass, site_particle, site_region_count, region_share):
    """See `melt.reference.lattice.region_share`."""
    _region_share.launch(site_particle.shape[0], mass, site_particle, site_region_count, region_share)


@cuda_kernel
def _region_rest(site_region, site_region_count, site_dirty, region_share, lattice, region_mass, region_rest):
    s = cuda.grid(1)
    if s >= site_region_count.shape[0] or not site_dirty[s] & 2:
        return
    real = type(lattice.spacing)
    w, dx = lattice.width, lattice.spacing
    side = 2 * w + 1
    total, x, y, z = real(0), real(0), real(0), real(0)
    if site_region_count[s] > 0:
        for k in range(site_region.shape[1]):
            j = site_region[s, k]
            if j >= 0:
                m = region_share[j]
                total += m
                x += m * (real(k % side - w) * dx)
                y += m * (real(k // side % side - w) * dx)
                z += m * (real(k // (side * side) - w) * dx)
        x, y, z = x / total, y / total, z / total
    region_mass[s] = total
    region_rest[0, s], region_rest[1, s], region_rest[2, s] = x, y, z


def region_rest(site_region, site_region_count, site_dirty, region_share, lattice, region_mass, region_rest):
    """See `melt.reference.lattice.region_rest`."""
    _region_rest.launch(
        site_region_count.shape[0], site_region, site_region_count, site_dirty, region_share, lattice,
        region_mass, region_rest,
    )


@cuda_kernel
def _gather_positions(position, site_particle, site_position):
    s = cuda.grid(1)
    if s >= site_particle.shape[0]:
        return
    p = site_particle[s]
    for a in range(3):
        site_position[a, s] = position[a, p] if p >= 0 else position.dtype.type(0)


@cuda_kernel
def _region_match(
    site_region, site_region_count, region_share, region_mass, region_rest, lattice, site_position,
    region_rotation, region_mean, region_shift,
):
    s = cuda.grid(1)
    if s >= site_region_count.shape[0]:
        return
    real = type(lattice.spacing)
    wide = site_position.dtype.type
    if site_region_count[s] == 0:
        for a in range(3):
            region_mean[a, s] = real(0)
            region_shift[a, s] = real(0)
        return
    w, dx = lattice.width, lattice.spacing
    side = 2 * w + 1
    x_s, y_s, z_s = site_position[0, s], site_position[1, s], site_position[2, s]
    X_s, Y_s, Z_s = region_rest[0, s], region_rest[1, s], region_rest[2, s]
    ex, ey, ez = wide(0), wide(0), wide(0)
    cx, cy, cz = wide(0), wide(0), wide(0)
    a0, a1, a2 = wide(0), wide(0), wide(0)
    a3, a4, a5 = wide(0), wide(0), wide(0)
    a6, a7, a8 = wide(0), wide(0), wide(0)
    for k in range(site_region.shape[1]):
        j = site_region[s, k]
        if j < 0:
            continue
        m = region_share[j]
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
        X = real(k % side - w) * dx - X_s
        Y = real(k // side % side - w) * dx - Y_s
        Z = real(k // (side * side) - w) * dx - Z_s
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
    region_rotation[0, s], region_rotation[1, s], region_rotation[2, s], region_rotation[3, s] = q
    r = rotate(q[0], q[1], q[2], q[3], X_s, Y_s, Z_s)
    region_shift[0, s] = real(cx / M) - r[0]
    region_shift[1, s] = real(cy / M) - r[1]
    region_shift[2, s] = real(cz / M) - r[2]


def region_match(
    position, site_particle, site_region, site_region_count, region_share, region_mass, region_rest,
    lattice, site_position, region_rotation, region_mean, region_shift,
):
    """See `melt.reference.lattice.region_match`."""
    sites = site_particle.shape[0]
    _gather_positions.launch(sites, position, site_particle, site_position)
    _region_match.launch(
        sites, site_region, site_region_count, region_share, region_mass, region_rest, lattice, site_position,
        region_rotation, region_mean, region_shift,
    )


@cuda_kernel
def _goal(site_region, site_region_count, region_rotation, region_mean, region_shift, lattice, goal):
    s = cuda.grid(1)
    if s >= site_region_count.shape[0]:
        return
    real = type(lattice.spacing)
    if site_region_count[s] == 0:
        for a in range(3):
            goal[a, s] = real(0)
        return
    w, dx = lattice.width, lattice.spacing
    side = 2 * w + 1
    gx, gy, gz = real(0), real(0), real(0)
    for k in range(site_region.shape[1]):
        j = site_region[s, k]
        if j < 0:
            continue
        # the region of site j sees this site at minus the offset
        r = rotate(
            region_rotation[0, j], region_rotation[1, j], region_rotation[2, j], region_rotation[3, j],
            real(w - k % side) * dx, real(w - k // side % side) * dx, real(w - k // (side * side)) * dx,
        )
        gx += r[0] + region_shift[0, j]
        gy += r[1] + region_shift[1, j]
        gz += r[2] + region_shift[2, j]
    n = real(site_region_count[s])
    goal[0, s] = gx / n + region_mean[0, s]
    goal[1, s] = gy / n + region_mean[1, s]
    goal[2, s] = gz / n + region_mean[2, s]


def goal(site_region, site_region_count, region_rotation, region_mean, region_shift, lattice, goal):
    """See `melt.reference.lattice.goal`."""
    _goal.launch(
        site_region_count.shape[0], site_region, site_region_count, region_rotation, region_mean,
        region_shift,
        lattice, goal,
    )
