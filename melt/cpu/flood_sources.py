"""CPU twin of `melt.reference.flood_sources`."""

from melt._compile import cpu_stage, prange
from melt.physics.flood_motion import kept_volume
from melt.physics.phases import INACTIVE, LIQUID


@cpu_stage
def infiltrate(depth, rate, thinnest, dt, phase, mass, rest_volume, left_volume):
    """See `melt.reference.flood_sources.infiltrate`."""
    n, pieces = phase.shape[0], left_volume.shape[1]
    for p in prange(pieces):
        seeped = rest = 0.0
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            if phase[i] != LIQUID:
                continue
            V = rest_volume[i]
            kept = kept_volume(V, depth[i], rate * dt)
            mass[i] *= kept / V
            rest_volume[i] = kept
            seeped += float(V) - float(kept)
            if kept < thinnest:
                phase[i] = INACTIVE
                rest += kept
        left_volume[2, p], left_volume[3, p] = seeped, rest
