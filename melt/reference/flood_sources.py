r"""Water that seeps away. Flood spec E19: :math:`\dot V_i = -f A_i,\ A_i = V_i/d_i`, f a constant rate."""

import numpy as np

from melt.reference._flood_motion import piece_sums


def infiltrate(depth, rate, thinnest, dt, phase, mass, rest_volume, left_volume):
    """Take what seeps into the ground from liquid columns, and take away columns that have become too thin.

    Mass goes with the volume. What is booked is the difference of the stored volumes, so that the balance holds to
    the last bit whatever the precision. In single precision less than 3e-8 of a depth cannot be taken at all: 10 mm/h
    in a sub-step of 0.01 s from a metre of water. Let ``dt`` gather until rate dt is about 1e-4 m.

    Reads: depth (n,) [m]; rate [m/s], thinnest [m^3].
    Writes: phase (n,), mass (n,) [kg], rest_volume (n,) [m^3] of liquid columns; left_volume (4, 64), rows 2 (seeped)
        and 3 (rest of removed columns) [m^3]; others keep theirs. Pieces as in `flood_guard`.
    """
    on = phase == 0
    V = rest_volume.astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        kept = V - float(rate) * float(dt) * V / depth.astype(np.float64)
        kept = np.where(kept < 0, 0.0, kept)
        share = kept / V
    mass[on] = (mass.astype(np.float64) * share)[on]
    rest_volume[on] = kept[on]
    seeped = np.where(on, V - rest_volume.astype(np.float64), 0.0)
    thin = on & (rest_volume < thinnest)
    phase[thin] = 5
    left_volume[2], left_volume[3] = piece_sums(seeped), piece_sums(np.where(thin, rest_volume, 0.0))
