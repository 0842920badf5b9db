"""Weights between nodes and APIC particles, all pairs at once. Slime spec 2.1."""

import numpy as np

from melt.reference._pairs import W

#: Places of a symmetric tensor's components.
SIX = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def wrapped(d, period):
    """Return differences of positions (3, ...) taken to the nearest image [m]."""
    d = np.array(d, dtype=np.float64)
    for a, axis in enumerate("xyz"):
        length, inverse = float(getattr(period, f"length_{axis}")), float(getattr(period, f"inverse_{axis}"))
        d[a] -= length * np.floor(d[a] * inverse + 0.5)
    return d


def pairs(position, phase, apic_position, period, apic):
    """Return d = x_I - x_p (3, n, P) [m] and W(|d|, h_t) (n, P), 0 where the node is no liquid."""
    x, x_p = position.astype(np.float64), apic_position.astype(np.float64)
    d = wrapped(x[:, :, None] - x_p[:, None, :], period)
    r = np.sqrt((d**2).sum(axis=0))
    return d, np.where((phase == 0)[:, None], W(r, apic), 0.0)


def shares(W, apic_weight):
    """Return w_Ip = W / S_p (n, P), 0 for orphans and inactive APIC particles."""
    S = apic_weight.astype(np.float64)
    return W * np.where(S > 0, 1 / np.where(S > 0, S, 1.0), 0.0)


def full(six):
    """Return symmetric matrices (P, 3, 3) from their components (6, P)."""
    matrix = np.zeros((np.shape(six)[1], 3, 3))
    for k, (a, b) in enumerate(SIX):
        matrix[:, a, b] = matrix[:, b, a] = six[k]
    return matrix


def six_of(matrix):
    """Return the components (6, P) of symmetric matrices (P, 3, 3)."""
    return np.array([matrix[:, a, b] for a, b in SIX])


def nine(C):
    """Return matrices (P, 3, 3) of fields (9, P)."""
    return np.moveaxis(np.reshape(np.asarray(C, dtype=np.float64), (3, 3, np.shape(C)[1])), 2, 0)
