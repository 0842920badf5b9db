"""Columns that enter. Flood spec E17, E19."""

import numpy as np


def entry_clearance(entry_position, position, phase, cell_start, grid, flood, entry_clearance):
    """Write the distance in the plane from each entry to the nearest liquid column, at most ``largest``.

    Reads: entry_position (3, entries) [m], position (3, n) [m], phase (n,); the grid is not used (all pairs).
    Writes: entry_clearance (entries,) [m].
    """
    x = position[:2, phase == 0].astype(np.float64)
    for e in range(entry_clearance.shape[0]):
        apart = np.hypot(*(x - entry_position[:2, e : e + 1].astype(np.float64)))
        entry_clearance[e] = np.fmin.reduce(apart, initial=float(flood.largest))  # a NaN place is nowhere near


def enter(
    entry_position, entry_velocity, entry_volume, flood, count, slot, density, first_id,
    phase, id, position, velocity, mass, rest_volume, support_radius, position_before, depth, brake,
):
    """Put the first ``count`` entries into the slots from ``slot`` as water, with ids from ``first_id``.

    The support starts as that of a column of the reference depth, h = ratio sqrt(V/d_ref), clamped (E8): the largest
    would list hundreds of neighbours where the water stands, and h shrinks freely but grows slowly. The depth fits it.

    Reads: entry_position (3, entries) [m], entry_velocity (3, entries) [m/s], entry_volume (entries,) [m^3];
        density [kg/m^3] of water.
    Writes: phase, id, position and position_before [m], velocity [m/s], mass [kg], rest_volume [m^3],
        support_radius [m], depth [m], brake (0) of those slots; others keep theirs.
        position_before and brake have length 0 without a control force.
    """
    rows, slots = slice(0, int(count)), slice(int(slot), int(slot) + int(count))
    V = entry_volume[rows].astype(np.float64)
    ratio = float(flood.ratio)
    h = np.clip(ratio * np.sqrt(V / float(flood.reference_depth)), float(flood.smallest), float(flood.largest))
    phase[slots], id[slots] = 0, int(first_id) + np.arange(int(count))
    position[:, slots] = entry_position[:, rows]
    if position_before.shape[1]:
        position_before[:, slots] = entry_position[:, rows]
    velocity[:, slots] = entry_velocity[:, rows]
    mass[slots], rest_volume[slots] = float(density) * V, V
    support_radius[slots], depth[slots] = h, V * (ratio / h) ** 2
    if brake.shape[0]:
        brake[slots] = 0
