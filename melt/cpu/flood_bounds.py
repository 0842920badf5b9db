"""CPU twin of `melt.reference.flood_bounds`."""

import math

from melt._compile import cpu_stage, prange
from melt.physics.flood_forces import nan_to_infinity
from melt.physics.phases import LIQUID


@cpu_stage
def flood_bounds(phase, velocity, acceleration, depth, support_radius, depth_state, flood, terrain_grid, flood_bounds):
    """See `melt.reference.flood_bounds.flood_bounds`."""
    real = type(flood.gravity)
    n, pieces = phase.shape[0], flood_bounds.shape[1]
    per_cell = max(terrain_grid.inverse_dx, terrain_grid.inverse_dy)
    for p in prange(pieces):
        wave = push = crossing = fastest = widest = clamped = real(0)
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            if phase[i] != LIQUID:
                continue
            u, v, h = velocity[0, i], velocity[1, i], support_radius[i]
            a, b = acceleration[0, i], acceleration[1, i]
            speed, over_l = math.sqrt(u * u + v * v), real(2) / h
            over_least = per_cell if per_cell > over_l else over_l  # NaN stays
            wave = max(wave, nan_to_infinity((math.sqrt(flood.gravity * depth[i]) + speed) * over_l))
            push = max(push, nan_to_infinity(math.sqrt(a * a + b * b) * over_l))
            crossing = max(crossing, nan_to_infinity(speed * over_least))
            fastest = max(fastest, nan_to_infinity(speed))
            widest = max(widest, nan_to_infinity(h))
            clamped += real(depth_state[i] & 3 != 0)
        flood_bounds[0, p], flood_bounds[1, p], flood_bounds[2, p] = wave, push, crossing
        flood_bounds[3, p], flood_bounds[4, p], flood_bounds[5, p] = fastest, widest, clamped
