"""CPU twin of `melt.reference.heat_coloured`.

Without latent heat the rounds of two cells run in SIMD lanes: lane t holds A_t, and the
partners B_((t+r) mod n) of round r are the n entries from r on of a buffer that holds B twice.
Sliding that window by one entry per round costs one copied temperature. Idle lanes have V = 0.
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange, scalar
from melt.params import HEAT_PAPER, L_VISC
from melt.physics.heat import pair_factor, pair_latent, pair_weight
from melt.physics.smoothing import laplacian_weight

ROW = 256  # entries of a buffer row: one flat buffer, so that rows are known not to overlap
LARGEST = 120  # particles of a cell that fit twice into a row with padding
U = np.uint64
AX, AY, AZ, AK, AV, AC, AT = (U(k * ROW) for k in range(7))
BX, BY, BZ, BK, BV, BC, BT = (U(k * ROW) for k in range(7, 14))


@cpu_helper
def _offset(place):
    """Return half-shell offset 1..13 as (x, y, z): x alone, then y = 1, then z = 1."""
    if place == 1:
        return 1, 0, 0
    if place < 5:
        return place - 3, 1, 0
    return (place - 5) % 3 - 1, (place - 5) // 3 - 1, 1


@scalar
def _quotient(a, b):
    """Return a / b where fastmath must not turn (a / b) D into (a D) / b.

    Then the division does not wait for the temperatures of the round before.
    """
    return a / b


@cpu_helper
def _run_rounds(S, n, lanes, back, paper, smoothing):
    """Run the n rounds of the two buffered cells.

    `L_visc` has a loop of its own: left to itself the compiler evaluates all weights and
    selects (6 divisions instead of 1, measured 2x slower).
    """
    real = type(smoothing.support)
    zero, one, largest, h = real(0), real(1), real(1e30), smoothing.support
    scale = laplacian_weight(zero, smoothing) / h
    linear = smoothing.laplacian == L_VISC
    for go in range(n):
        r = n - U(1) - go if back else go
        if linear:
            for t in range(lanes):
                x = S[AX + t] - S[BX + r + t]
                y = S[AY + t] - S[BY + r + t]
                z = S[AZ + t] - S[BZ + r + t]
                weight = scale * max(h - math.sqrt(x * x + y * y + z * z), zero)
                w = S[AV + t] * (S[BV + r + t] * weight)
                k = S[AK + t] + S[BK + r + t]
                g = min(k * w, largest) if paper else w
                f = _quotient(g, (one if paper else k) + g * (S[AC + t] + S[BC + r + t]))
                q = f * (S[BT + r + t] - S[AT + t])
                S[AT + t] += q * S[AC + t]
                S[BT + r + t] -= q * S[BC + r + t]
        else:
            for t in range(lanes):
                x = S[AX + t] - S[BX + r + t]
                y = S[AY + t] - S[BY + r + t]
                z = S[AZ + t] - S[BZ + r + t]
                weight = laplacian_weight(math.sqrt(x * x + y * y + z * z), smoothing)
                w = S[AV + t] * (S[BV + r + t] * weight)
                k = S[AK + t] + S[BK + r + t]
                g = min(k * w, largest) if paper else w
                f = _quotient(g, (one if paper else k) + g * (S[AC + t] + S[BC + r + t]))
                q = f * (S[BT + r + t] - S[AT + t])
                S[AT + t] += q * S[AC + t]
                S[BT + r + t] -= q * S[BC + r + t]
        if not back:
            S[BT + r + n] = S[BT + r]
        elif r > U(0):
            S[BT + r - U(1)] = S[BT + r - U(1) + n]


@cpu_helper
def _walk_rounds(
    a0, a, b0, b, n, within, back, position, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
    latent_point, latent_capacity, smoothing, heat, step, temperature, latent_energy,
):
    """Run the n rounds of two cells, or of one (``within``), pair by pair in place."""
    real = type(smoothing.support)
    zero, one = real(0), real(1)
    support2 = smoothing.support * smoothing.support
    for go in range(n):
        r = n - 1 - go if back else go
        for t in range((n + 1) // 2 if within else a):
            if within:  # circle method: player n stays
                s = r if t == 0 else (r + t) % n
                u = n if t == 0 else (r - t + n) % n
            else:
                s, u = t, t + r if t + r < n else t + r - n
            if s >= a or u >= b:
                continue
            i, j = U(a0 + s), U(b0 + u)
            x = real(position[0, i] - position[0, j])
            y = real(position[1, i] - position[1, j])
            z = real(position[2, i] - position[2, j])
            r2 = x * x + y * y + z * z
            if r2 >= support2:
                continue
            w = pair_weight(math.sqrt(r2), heat_volume[i], heat_volume[j], step, smoothing)
            if w == zero:
                continue
            if heat.latent == 0:
                flow_i, flow_j = one / heat_capacity[i], one / heat_capacity[j]
                f = pair_factor(w, conductivity[i], conductivity[j], flow_i + flow_j, heat)
                q = f * (temperature[j] - temperature[i])
                temperature[i] += q * flow_i
                temperature[j] -= q * flow_j
                continue
            g = pair_factor(w, conductivity[i], conductivity[j], zero, heat)
            T_i, e_i, T_j, e_j = pair_latent(
                g, temperature[i], latent_energy[i], latent_point[i], heat_capacity[i],
                heat_capacity_molten[i], latent_capacity[i], temperature[j], latent_energy[j],
                latent_point[j], heat_capacity[j], heat_capacity_molten[j], latent_capacity[j],
            )
            temperature[i], latent_energy[i] = T_i, e_i
            temperature[j], latent_energy[j] = T_j, e_j


@cpu_helper
def _load(
    S, row, first, count, size, position, conductivity, heat_volume, heat_capacity, temperature, origin,
    factor, paper,
):
    """Copy a cell into 7 rows of the buffer from ``row`` on; entries up to ``size`` are nobody."""
    real = type(factor)
    one, half = real(1), real(0.5)
    x0, y0, z0 = position[0, origin], position[1, origin], position[2, origin]
    for t in range(U(count)):
        i = U(first) + t
        k = conductivity[i]
        S[row + t] = real(position[0, i] - x0)
        S[row + AY + t] = real(position[1, i] - y0)
        S[row + AZ + t] = real(position[2, i] - z0)
        S[row + AK + t] = k if paper else half / k
        S[row + AV + t] = factor * heat_volume[i]
        S[row + AC + t] = one / heat_capacity[i]
        S[row + AT + t] = temperature[i]
    for t in range(U(count), U(size)):
        S[row + AK + t] = one
        S[row + AV + t] = real(0)
        S[row + AC + t] = real(0)


@cpu_helper
def _sweep_owner(
    S, cell, cx, cy, cz, back, position, conductivity, heat_volume, heat_capacity, heat_capacity_molten,
    latent_point, latent_capacity, cell_start, smoothing, grid, heat, step, temperature, latent_energy,
):
    """Run a cell with itself and its 13 half-shell neighbours, or all of that backwards."""
    paper = heat.law == HEAT_PAPER
    nx, ny, nz = int(grid.nx), int(grid.ny), int(grid.nz)
    a0 = int(cell_start[cell])
    a = int(cell_start[cell + 1]) - a0
    loaded = False
    for turn in range(14 if a > 0 else 0):
        place = 13 - turn if back else turn
        b0, b, n = a0, a, a + a % 2 - 1
        if place > 0:
            ox, oy, oz = _offset(place)
            if not (0 <= cx + ox < nx and 0 <= cy + oy < ny and cz + oz < nz):
                continue
            other = cell + (oz * ny + oy) * nx + ox
            b0 = int(cell_start[other])
            b = int(cell_start[other + 1]) - b0
            n = max(a, b) if b > 0 else 0
        if place == 0 or heat.latent != 0 or n > LARGEST:
            if loaded:
                for t in range(U(a)):
                    temperature[U(a0) + t] = S[AT + t]
                loaded = False
            _walk_rounds(
                a0, a, b0, b, n, place == 0, back, position, conductivity, heat_volume, heat_capacity,
                heat_capacity_molten, latent_point, latent_capacity, smoothing, heat, step, temperature,
                latent_energy,
            )
            continue
        if n == 0:
            continue
        if not loaded:
            _load(S, AX, a0, a, (a + 7) // 8 * 8, position, conductivity, heat_volume, heat_capacity,
                  temperature, a0, step, paper)
            loaded = True
        _load(S, BX, b0, b, n, position, conductivity, heat_volume, heat_capacity, temperature, a0,
              type(step)(1), paper)
        for row in range(7, 14):
            base = U(row * ROW)
            for u in range(U(n)):
                S[base + U(n) + u] = S[base + u]
        _run_rounds(S, U(n), U((a + 7) // 8 * 8), back, paper, smoothing)
        start = BT if back else BT + U(n)
        for u in range(U(b)):
            temperature[U(b0) + u] = S[start + u]
    if loaded:
        for t in range(U(a)):
            temperature[U(a0) + t] = S[AT + t]


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
        for chunk in prange(64):
            S = np.zeros(14 * ROW, temperature.dtype)
            for owner in range(chunk, mx * my * mz, 64):
                cx = kx + 3 * (owner % mx)
                cy = ky + 3 * (owner // mx % my)
                cz = kz + 2 * (owner // (mx * my))
                _sweep_owner(
                    S, (cz * ny + cy) * nx + cx, cx, cy, cz, back, position, conductivity, heat_volume,
                    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, cell_start, smoothing,
                    grid, heat, step, temperature, latent_energy,
                )
