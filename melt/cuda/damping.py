"""CUDA twin of `melt.reference.damping`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.polar import solve_inertia


@cuda_kernel
def _gather_velocities(velocity, site_particle, site_velocity):
    s = cuda.grid(1)
    if s >= site_particle.shape[0]:
        return
    p = site_particle[s]
    for a in range(3):
        site_velocity[a, s] = velocity[a, p] if p >= 0 else velocity.dtype.type(0)


@cuda_kernel
def _region_motion(
    site_position, site_velocity, site_region, site_region_count, region_share, region_mass, region_centre,
    region_velocity, region_spin,
):
    s = cuda.grid(1)
    if s >= site_region_count.shape[0]:
        return
    real = region_share.dtype.type
    wide = site_position.dtype.type
    if site_region_count[s] == 0:
        for a in range(3):
            region_centre[a, s] = real(0)
            region_velocity[a, s] = real(0)
            region_spin[a, s] = real(0)
        return
    x_s, y_s, z_s = site_position[0, s], site_position[1, s], site_position[2, s]
    u_s, v_s, w_s = site_velocity[0, s], site_velocity[1, s], site_velocity[2, s]
    cx, cy, cz = wide(0), wide(0), wide(0)
    px, py, pz = wide(0), wide(0), wide(0)
    lx, ly, lz = wide(0), wide(0), wide(0)
    xx, yy, zz = wide(0), wide(0), wide(0)
    xy, xz, yz = wide(0), wide(0), wide(0)
    for k in range(site_region.shape[1]):
        j = site_region[s, k]
        if j < 0:
            continue
        m = region_share[j]
        x = real(site_position[0, j] - x_s)
        y = real(site_position[1, j] - y_s)
        z = real(site_position[2, j] - z_s)
        u, v, w = site_velocity[0, j] - u_s, site_velocity[1, j] - v_s, site_velocity[2, j] - w_s
        X, Y, Z = m * x, m * y, m * z
        cx += X
        cy += Y
        cz += Z
        px += m * u
        py += m * v
        pz += m * w
        lx += Y * w - Z * v
        ly += Z * u - X * w
        lz += X * v - Y * u
        xx += X * x
        yy += Y * y
        zz += Z * z
        xy += X * y
        xz += X * z
        yz += Y * z
    M = wide(region_mass[s])
    cx, cy, cz = cx / M, cy / M, cz / M
    # about the centre: L - c x P, and the parallel axis theorem
    lx, ly, lz = lx - (cy * pz - cz * py), ly - (cz * px - cx * pz), lz - (cx * py - cy * px)
    xx, yy, zz = xx - M * cx * cx, yy - M * cy * cy, zz - M * cz * cz
    xy, xz, yz = xy - M * cx * cy, xz - M * cx * cz, yz - M * cy * cz
    spin = solve_inertia(
        (real(yy + zz), real(xx + zz), real(xx + yy), real(-xy), real(-xz), real(-yz)),
        (real(lx), real(ly), real(lz)),
    )
    region_spin[0, s], region_spin[1, s], region_spin[2, s] = spin
    region_centre[0, s], region_centre[1, s], region_centre[2, s] = cx, cy, cz
    region_velocity[0, s] = u_s + real(px / M)
    region_velocity[1, s] = v_s + real(py / M)
    region_velocity[2, s] = w_s + real(pz / M)


def region_motion(
    velocity, site_particle, site_position, site_region, site_region_count, region_share, region_mass,
    site_velocity, region_centre, region_velocity, region_spin,
):
    """See `melt.reference.damping.region_motion`."""
    sites = site_particle.shape[0]
    _gather_velocities.launch(sites, velocity, site_particle, site_velocity)
    _region_motion.launch(
        sites, site_position, site_velocity, site_region, site_region_count, region_share, region_mass,
        region_centre,
        region_velocity, region_spin,
    )


@cuda_kernel
def _damp_velocity(
    site_particle, site_position, site_velocity, site_region, site_region_count, region_centre,
    region_velocity,
    region_spin, factor, velocity,
):
    s = cuda.grid(1)
    if s >= site_particle.shape[0] or site_region_count[s] == 0:
        return
    real = site_velocity.dtype.type
    x_s, y_s, z_s = site_position[0, s], site_position[1, s], site_position[2, s]
    u_s, v_s, w_s = site_velocity[0, s], site_velocity[1, s], site_velocity[2, s]
    u, v, w = real(0), real(0), real(0)
    for k in range(site_region.shape[1]):
        j = site_region[s, k]
        if j < 0:
            continue
        x = real(x_s - site_position[0, j]) - region_centre[0, j]
        y = real(y_s - site_position[1, j]) - region_centre[1, j]
        z = real(z_s - site_position[2, j]) - region_centre[2, j]
        a, b, c = region_spin[0, j], region_spin[1, j], region_spin[2, j]
        u += region_velocity[0, j] - u_s + (b * z - c * y)
        v += region_velocity[1, j] - v_s + (c * x - a * z)
        w += region_velocity[2, j] - w_s + (a * y - b * x)
    p = site_particle[s]
    share = factor / real(site_region_count[s])
    velocity[0, p] = u_s + share * u
    velocity[1, p] = v_s + share * v
    velocity[2, p] = w_s + share * w


def damp_velocity(
    site_particle, site_position, site_velocity, site_region, site_region_count, region_centre,
    region_velocity,
    region_spin, factor, velocity,
):
    """See `melt.reference.damping.damp_velocity`."""
    _damp_velocity.launch(
        site_particle.shape[0], site_particle, site_position, site_velocity, site_region, site_region_count,
        region_centre, region_velocity, region_spin, factor, velocity,
    )
