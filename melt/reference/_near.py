"""Brute force neighbour lists, the truth for every search."""

import numpy as np


def write_near(position, phase, smoothing, neighbour_count, neighbour_index):
    """Write for each particle but walls and inactive ones all j != i with r_ij < h that are not inactive."""
    x = position.astype(np.float64)
    h = float(smoothing.support)
    for i in range(phase.shape[0]):
        near = np.empty(0, dtype=np.intp)
        if phase[i] not in (2, 5):
            with np.errstate(invalid="ignore", over="ignore"):
                x_ij = x[:, i, None] - x
                near = np.flatnonzero(((x_ij**2).sum(axis=0) < h**2) & (phase != 5))
            near = near[near != i]
        neighbour_count[i] = near.size
        stored = min(near.size, neighbour_index.shape[1])
        neighbour_index[i, :stored] = near[:stored]
