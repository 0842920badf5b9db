"""Pairwise implicit heat exchange in an order that can run in parallel. Melting spec 2.5.

Particles are sorted by cell (edge >= h). Each cell owns itself and 13 half-shell offsets;
owners of one of 18 colours (cx mod 3, cy mod 3, cz mod 2) touch disjoint cells. Inside a pair
of cells A, B round r pairs A_t with B_((t+r) mod n), n = max(|A|, |B|); inside one cell the
rounds are those of the circle method. All pairs of a round are disjoint, so neither
threads nor SIMD lanes can change the result.
"""

import numpy as np

from melt.reference._enthalpy import Enthalpy, conductances, latent_of

OFFSETS = (
    [(0, 0, 0), (1, 0, 0)]
    + [(a, 1, 0) for a in (-1, 0, 1)]
    + [(a, b, 1) for b in (-1, 0, 1) for a in (-1, 0, 1)]
)


def _colour(cx, cy, cz):
    """Return the colour 0..17 of a cell."""
    return cx % 3 + 3 * (cy % 3) + 9 * (cz % 2)


def _rounds_between(A, B):
    """Yield the pairs of two cells (lists of particles) round by round."""
    n = max(len(A), len(B)) if A and B else 0
    for r in range(n):
        for t in range(n):
            u = (t + r) % n
            if t < len(A) and u < len(B):
                yield A[t], B[u]


def _rounds_within(A):
    """Yield the pairs of one cell by the circle method; player m-1 stays, m even."""
    m = len(A) + len(A) % 2
    for r in range(m - 1):
        for k in range(m // 2):
            a, b = ((r + k) % (m - 1), (r - k) % (m - 1)) if k else (r, m - 1)
            if a < len(A) and b < len(A):
                yield A[a], A[b]


def _coloured_order(cell_start, nx, ny, nz):
    """Return all pairs of particles of adjacent cells in the order of the sweep."""
    def members(cx, cy, cz):
        if not (0 <= cx < nx and 0 <= cy < ny and 0 <= cz < nz):
            return []
        c = (cz * ny + cy) * nx + cx
        return list(range(int(cell_start[c]), int(cell_start[c + 1])))

    cells = [(cx, cy, cz) for cz in range(nz) for cy in range(ny) for cx in range(nx)]
    pairs = []
    for wanted in range(18):
        for cx, cy, cz in cells:
            if _colour(cx, cy, cz) != wanted:
                continue
            A = members(cx, cy, cz)
            pairs += _rounds_within(A)
            for a, b, c in OFFSETS[1:]:
                pairs += _rounds_between(A, members(cx + a, cy + b, cz + c))
    return pairs


def heat_pairs_coloured(
    position, conductivity, heat_volume, heat_capacity, heat_capacity_molten, latent_point,
    latent_capacity, cell_start, smoothing, grid, heat, dt, temperature, latent_energy,
):
    """Step every pair alone by backward Euler in coloured order with dt/2, then in exact reverse.

    Reads: position (3, n) [m] of particles sorted by cell, cell_start; k, V, C and enthalpy fields.
    Writes: temperature (n,) [degC], latent_energy (n,) [J].
    """
    n = len(temperature)
    G = conductances(position, conductivity, heat_volume, smoothing, heat)
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    T, e = temperature.astype(np.float64), latent_of(heat, latent_energy, n)
    order = _coloured_order(cell_start, int(grid.nx), int(grid.ny), int(grid.nz))
    step = float(dt) * (1.0 if heat.full_sweep else 0.5)
    for i, j in order + order[::-1]:
        curve.exchange(step * G[i, j], i, j, T, e)
    temperature[:] = T
    if heat.latent:
        latent_energy[:] = e
