"""CPU twin of `melt.reference.heat_coloured`."""

import math


from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.heat import pair_factor, pair_latent, pair_weight


@cpu_helper
def exchange(
    i, j, position, conductivity, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, smoothing, heat, dt, temperature, latent_energy,
):
    """Step the pair (i, j) alone, in place."""
    real = type(smoothing.support)
    x = real(position[0, i] - position[0, j])
    y = real(position[1, i] - position[1, j])
    z = real(position[2, i] - position[2, j])
    r2 = x * x + y * y + z * z
    if r2 >= smoothing.support * smoothing.support:
        return
    w = pair_weight(math.sqrt(r2), heat_volume[i], heat_volume[j], dt, smoothing)
    if w == real(0):
        return
    if heat.latent == 0:
        flow_i, flow_j = real(1) / heat_capacity[i], real(1) / heat_capacity[j]
        q = pair_factor(w, conductivity[i], conductivity[j], flow_i + flow_j, heat)
        q *= temperature[j] - temperature[i]
        temperature[i] += q * flow_i
        temperature[j] -= q * flow_j
        return
    g = pair_factor(w, conductivity[i], conductivity[j], real(0), heat)
    T_i, e_i, T_j, e_j = pair_latent(
        g, temperature[i], latent_energy[i], latent_point[i], heat_capacity[i],
        heat_capacity_molten[i], latent_capacity[i], temperature[j], latent_energy[j],
        latent_point[j], heat_capacity[j], heat_capacity_molten[j], latent_capacity[j],
    )
    temperature[i], latent_energy[i] = T_i, e_i
    temperature[j], latent_energy[j] = T_j, e_j


@cpu_helper
def offset_of(place):
    """Return half-shell offset 1..13 as (x, y, z): x alone, then y = 1, then z = 1."""
    if place == 1:
        return 1, 0, 0
    if place < 5:
        return place - 3, 1, 0
    return (place - 5) % 3 - 1, (place - 5) // 3 - 1, 1


@cpu_stage
def heat_pairs_coloured(
    position, conductivity, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, cell_start, smoothing, grid, heat, dt, temperature, latent_energy,
):
    """See `melt.reference.heat_coloured.heat_pairs_coloured`."""
    real = type(smoothing.support)
    step = dt if heat.full_sweep != 0 else real(0.5) * dt
    nx, ny, nz = int(grid.nx), int(grid.ny), int(grid.nz)
    for launch in range(36):
        back = launch >= 18
        colour = 35 - launch if back else launch
        kx, ky, kz = colour % 3, colour // 3 % 3, colour // 9
        mx, my, mz = (nx - kx + 2) // 3, (ny - ky + 2) // 3, (nz - kz + 1) // 2
        owners = mx * my * mz
        for chunk in prange(64):
            for owner in range(chunk, owners, 64):
                cx = kx + 3 * (owner % mx)
                cy = ky + 3 * (owner // mx % my)
                cz = kz + 2 * (owner // (mx * my))
                cell = (cz * ny + cy) * nx + cx
                a0 = int(cell_start[cell])
                a = int(cell_start[cell + 1]) - a0
                if a == 0:
                    continue
                for place in range(14):
                    if back:
                        place = 13 - place
                    if place == 0:
                        m = a + a % 2
                        for r in range(m - 1):
                            if back:
                                r = m - 2 - r
                            for k in range(m // 2):
                                s = r if k == 0 else (r + k) % (m - 1)
                                t = m - 1 if k == 0 else (r - k + m - 1) % (m - 1)
                                if s < a and t < a:
                                    exchange(
                                        a0 + s, a0 + t, position, conductivity, heat_volume, heat_capacity,
                                        heat_capacity_molten, latent_point, latent_capacity, smoothing,
                                        heat, step, temperature, latent_energy,
                                    )
                        continue
                    ox, oy, oz = offset_of(place)
                    if not (0 <= cx + ox < nx and 0 <= cy + oy < ny and cz + oz < nz):
                        continue
                    other = cell + (oz * ny + oy) * nx + ox
                    b0 = int(cell_start[other])
                    b = int(cell_start[other + 1]) - b0
                    n = max(a, b) if b > 0 else 0
                    for r in range(n):
                        if back:
                            r = n - 1 - r
                        for t in range(a):
                            u = t + r if t + r < n else t + r - n
                            if u < b:
                                exchange(
                                    a0 + t, b0 + u, position, conductivity, heat_volume, heat_capacity,
                                    heat_capacity_molten, latent_point, latent_capacity, smoothing,
                                    heat, step, temperature, latent_energy,
                                )
