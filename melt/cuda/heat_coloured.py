"""CUDA twin of `melt.reference.heat_coloured`: one thread per owner cell, one launch per colour.

A thread walks its 14 cell pairs and their rounds in the order of the method, so no barrier
is needed: owners of one colour touch disjoint cells.
"""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.heat import pair_factor, pair_latent, pair_weight


@cuda_kernel
def _heat_pairs_coloured(
    position, conductivity, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, cell_start, smoothing, grid, heat, step, colour, back, temperature, latent_energy,
):
    real = type(smoothing.support)
    support2 = smoothing.support * smoothing.support
    nx, ny, nz = int(grid.nx), int(grid.ny), int(grid.nz)
    kx, ky, kz = colour % 3, colour // 3 % 3, colour // 9
    mx, my, mz = (nx - kx + 2) // 3, (ny - ky + 2) // 3, (nz - kz + 1) // 2
    owner = cuda.grid(1)
    if owner >= mx * my * mz:
        return
    cx = kx + 3 * (owner % mx)
    cy = ky + 3 * (owner // mx % my)
    cz = kz + 2 * (owner // (mx * my))
    cell = (cz * ny + cy) * nx + cx
    a0 = int(cell_start[cell])
    a = int(cell_start[cell + 1]) - a0
    if a == 0:
        return
    for turn in range(14):
        place = 13 - turn if back else turn
        b0, b, rounds, lanes = a0, a, a + a % 2 - 1, (a + 1) // 2
        if place > 0:
            ox, oy, oz = 1, 0, 0
            if place >= 5:
                ox, oy, oz = (place - 5) % 3 - 1, (place - 5) // 3 - 1, 1
            elif place >= 2:
                ox, oy = place - 3, 1
            if cx + ox < 0 or cx + ox >= nx or cy + oy < 0 or cy + oy >= ny or cz + oz >= nz:
                continue
            other = cell + (oz * ny + oy) * nx + ox
            b0 = int(cell_start[other])
            b = int(cell_start[other + 1]) - b0
            rounds, lanes = max(a, b) if b > 0 else 0, a
        for go in range(rounds):
            r = rounds - 1 - go if back else go
            for t in range(lanes):
                if place > 0:
                    s, u = t, t + r if t + r < rounds else t + r - rounds
                else:  # circle method: player `rounds` stays
                    s = r if t == 0 else (r + t) % rounds
                    u = rounds if t == 0 else (r - t + rounds) % rounds
                if s >= a or u >= b:
                    continue
                i, j = a0 + s, b0 + u
                x = real(position[0, i] - position[0, j])
                y = real(position[1, i] - position[1, j])
                z = real(position[2, i] - position[2, j])
                r2 = x * x + y * y + z * z
                if r2 >= support2:
                    continue
                w = pair_weight(math.sqrt(r2), heat_volume[i], heat_volume[j], step, smoothing)
                if w == real(0):
                    continue
                if heat.latent == 0:
                    flow_i, flow_j = real(1) / heat_capacity[i], real(1) / heat_capacity[j]
                    f = pair_factor(w, conductivity[i], conductivity[j], flow_i + flow_j, heat)
                    q = f * (temperature[j] - temperature[i])
                    temperature[i] += q * flow_i
                    temperature[j] -= q * flow_j
                    continue
                g = pair_factor(w, conductivity[i], conductivity[j], real(0), heat)
                T_i, e_i, T_j, e_j = pair_latent(
                    g, temperature[i], latent_energy[i], latent_point[i], heat_capacity[i],
                    heat_capacity_molten[i], latent_capacity[i], temperature[j], latent_energy[j],
                    latent_point[j], heat_capacity[j], heat_capacity_molten[j], latent_capacity[j],
                )
                temperature[i], latent_energy[i] = T_i, e_i
                temperature[j], latent_energy[j] = T_j, e_j


def heat_pairs_coloured(
    position, conductivity, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, cell_start, smoothing, grid, heat, dt, temperature, latent_energy,
):
    """See `melt.reference.heat_coloured.heat_pairs_coloured`."""
    real = type(smoothing.support)
    step = dt if heat.full_sweep != 0 else real(0.5) * dt
    for launch in range(36):
        back = launch >= 18
        colour = 35 - launch if back else launch
        owners = ((int(grid.nx) + 2) // 3) * ((int(grid.ny) + 2) // 3) * ((int(grid.nz) + 1) // 2)
        _heat_pairs_coloured.launch(
            owners, position, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
            latent_point, latent_capacity, cell_start, smoothing, grid, heat, step, colour, back,
            temperature, latent_energy,
        )
