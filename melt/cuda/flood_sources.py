"""CUDA twin of `melt.reference.flood_sources`: first what will seep away is booked, then it goes."""

from melt._compile import cuda, cuda_kernel
from melt.physics.flood_motion import kept_volume
from melt.physics.phases import INACTIVE, LIQUID


@cuda_kernel
def _seepage_sums(depth, rate, thinnest, dt, phase, rest_volume, left_volume):
    p = cuda.grid(1)
    n, pieces = phase.shape[0], left_volume.shape[1]
    if p >= pieces:
        return
    seeped = rest = 0.0
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        if phase[i] != LIQUID:
            continue
        V = rest_volume[i]
        kept = kept_volume(V, depth[i], rate * dt)
        seeped += float(V) - float(kept)
        if kept < thinnest:
            rest += kept
    left_volume[2, p], left_volume[3, p] = seeped, rest


@cuda_kernel
def _seep(depth, rate, thinnest, dt, phase, mass, rest_volume):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] != LIQUID:
        return
    V = rest_volume[i]
    kept = kept_volume(V, depth[i], rate * dt)
    mass[i] *= kept / V
    rest_volume[i] = kept
    if kept < thinnest:
        phase[i] = INACTIVE


def infiltrate(depth, rate, thinnest, dt, phase, mass, rest_volume, left_volume):
    """See `melt.reference.flood_sources.infiltrate`."""
    _seepage_sums.launch(left_volume.shape[1], depth, rate, thinnest, dt, phase, rest_volume, left_volume)
    _seep.launch(phase.shape[0], depth, rate, thinnest, dt, phase, mass, rest_volume)
