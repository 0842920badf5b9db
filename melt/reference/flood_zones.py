"""Open boundaries with a given stage or discharge: what the water does beside them, and how they drive it. Flood spec E18.

The host turns the sums into mean depth V/A and mean velocity along the normal, and those into what the boundary
imposes (`melt.flood.open_boundary`).
"""

import numpy as np


def _inside(position, box):
    x, y = position[0], position[1]
    return (x >= box[0]) & (x < box[1]) & (y >= box[2]) & (y < box[3])


def zone_sums(position, velocity, phase, rest_volume, depth, zone_probe, zone_normal, zone_sums):
    """Write, for each zone, sums over the liquid columns of its probe: A = V/d, V v . n, V.

    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), rest_volume (n,) [m^3], depth (n,) [m],
        zone_probe (4, zones) [m], zone_normal (2, zones).
    Writes: zone_sums (3, zones) [m^2, m^4/s, m^3].
    """
    for z in range(zone_sums.shape[1]):
        on = (phase == 0) & _inside(position, zone_probe[:, z])
        V = rest_volume[on].astype(np.float64)
        speed = (zone_normal[:, z : z + 1].astype(np.float64) * velocity[:2, on].astype(np.float64)).sum(axis=0)
        zone_sums[:, z] = (V / depth[on].astype(np.float64)).sum(), (V * speed).sum(), V.sum()


def zone_drive(position, phase, zone_box, zone_normal, zone_speed, velocity):
    """Set the velocity of the liquid columns of each zone to its speed along its normal; NaN: not driven.

    A column in several boxes belongs to the first that drives.

    Reads: position (3, n) [m], phase (n,), zone_box (4, zones) [m], zone_normal (2, zones), zone_speed (zones,) [m/s].
    Writes: velocity (3, n) [m/s] of those columns; others keep theirs.
    """
    taken = phase != 0
    for z in range(zone_speed.shape[0]):
        if np.isnan(zone_speed[z]):
            continue
        on = _inside(position, zone_box[:, z]) & ~taken
        velocity[:2, on] = float(zone_speed[z]) * zone_normal[:, z : z + 1].astype(np.float64)
        taken |= on
