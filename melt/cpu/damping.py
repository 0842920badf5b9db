"""CPU twin of `melt.reference.damping`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.polar import solve_inertia


@cpu_stage
def region_motion(
    velocity, site_particle, site_position, site_region, site_region_count, region_share, region_mass,
    site_velocity, region_centre, region_velocity, region_spin,
):
    """See `melt.reference.damping.region_motion`; sums about the own particle, then moved to the centre."""
    real = region_share.dtype.type
    wide = site_position.dtype.type
    slots = np.uint64(site_region.shape[1])
    for s in prange(site_particle.shape[0]):
        p = site_particle[s]
        for a in range(3):
            site_velocity[a, s] = velocity[a, p] if p >= 0 else real(0)
    for s in prange(site_particle.shape[0]):
        if site_region_count[s] == 0:
            for a in range(3):
                region_centre[a, s] = real(0)
                region_velocity[a, s] = real(0)
                region_spin[a, s] = real(0)
            continue
        x_s, y_s, z_s = site_position[0, s], site_position[1, s], site_position[2, s]
        u_s, v_s, w_s = site_velocity[0, s], site_velocity[1, s], site_velocity[2, s]
        cx, cy, cz = wide(0), wide(0), wide(0)
        px, py, pz = wide(0), wide(0), wide(0)
        lx, ly, lz = wide(0), wide(0), wide(0)
        xx, yy, zz = wide(0), wide(0), wide(0)
        xy, xz, yz = wide(0), wide(0), wide(0)
        for k in range(slots):
            member = site_region[s, k]
            j = np.uint64(member if member >= 0 else s)
            m = region_share[j] if member >= 0 else real(0)
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


@cpu_stage
def damp_velocity(
    site_particle, site_position, site_velocity, site_region, site_region_count, region_centre,
    region_velocity,
    region_spin, factor, velocity,
):
    """See `melt.reference.damping.damp_velocity`."""
    real = site_velocity.dtype.type
    slots = np.uint64(site_region.shape[1])
    for s in prange(site_particle.shape[0]):
        if site_region_count[s] == 0:
            continue
        x_s, y_s, z_s = site_position[0, s], site_position[1, s], site_position[2, s]
        u_s, v_s, w_s = site_velocity[0, s], site_velocity[1, s], site_velocity[2, s]
        u, v, w = real(0), real(0), real(0)
        for k in range(slots):
            member = site_region[s, k]
            j = np.uint64(member if member >= 0 else s)
            here = real(1) if member >= 0 else real(0)
            x = real(x_s - site_position[0, j]) - region_centre[0, j]
            y = real(y_s - site_position[1, j]) - region_centre[1, j]
            z = real(z_s - site_position[2, j]) - region_centre[2, j]
            a, b, c = region_spin[0, j], region_spin[1, j], region_spin[2, j]
            u += here * (region_velocity[0, j] - u_s + (b * z - c * y))
            v += here * (region_velocity[1, j] - v_s + (c * x - a * z))
            w += here * (region_velocity[2, j] - w_s + (a * y - b * x))
        p = np.uint64(site_particle[s])
        share = factor / real(site_region_count[s])
        velocity[0, p] = u_s + share * u
        velocity[1, p] = v_s + share * v
        velocity[2, p] = w_s + share * w
