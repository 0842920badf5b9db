"""CUDA twin of `melt.reference.flood_zones`."""

import numpy as np

from melt._compile import cuda, cuda_kernel, device_empty
from melt.physics.flood_motion import inside_box
from melt.physics.phases import LIQUID

PIECES = 256


@cuda_kernel
def _zone_parts(position, velocity, phase, rest_volume, depth, zone_probe, zone_normal, part):
    t = cuda.grid(1)
    n, zones, pieces = phase.shape[0], part.shape[1], part.shape[2]
    if t >= zones * pieces:
        return
    z, p = t // pieces, t % pieces
    n_x, n_y = zone_normal[0, z], zone_normal[1, z]
    x_from, x_to, y_from, y_to = zone_probe[0, z], zone_probe[1, z], zone_probe[2, z], zone_probe[3, z]
    area = flow = volume = 0.0
    for i in range(p, n, pieces):  # neighbouring threads read neighbouring columns
        if phase[i] == LIQUID and inside_box(position[0, i], position[1, i], x_from, x_to, y_from, y_to):
            V = rest_volume[i]
            area += V / depth[i]
            flow += V * (n_x * velocity[0, i] + n_y * velocity[1, i])
            volume += V
    part[0, z, p], part[1, z, p], part[2, z, p] = area, flow, volume


@cuda_kernel
def _zone_totals(part, zone_sums):
    t = cuda.grid(1)
    zones, pieces = part.shape[1], part.shape[2]
    if t >= 3 * zones:
        return
    row, z = t // zones, t % zones
    total = 0.0
    for p in range(pieces):
        total += part[row, z, p]
    zone_sums[row, z] = total


def zone_sums(position, velocity, phase, rest_volume, depth, zone_probe, zone_normal, zone_sums):
    """See `melt.reference.flood_zones.zone_sums`; 256 partial sums for each zone, whatever the device."""
    zones = zone_sums.shape[1]
    if zones == 0:
        return
    part = device_empty((3, zones, PIECES), np.float64)
    _zone_parts.launch(
        zones * PIECES, position, velocity, phase, rest_volume, depth, zone_probe, zone_normal, part
    )
    _zone_totals.launch(3 * zones, part, zone_sums)


@cuda_kernel
def _zone_drive(position, phase, zone_box, zone_normal, zone_speed, velocity):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    if phase[i] != LIQUID:
        return
    x, y = position[0, i], position[1, i]
    for z in range(zone_speed.shape[0]):
        speed = zone_speed[z]
        if speed == speed and inside_box(x, y, zone_box[0, z], zone_box[1, z], zone_box[2, z], zone_box[3, z]):
            velocity[0, i], velocity[1, i] = speed * zone_normal[0, z], speed * zone_normal[1, z]
            break


def zone_drive(position, phase, zone_box, zone_normal, zone_speed, velocity):
    """See `melt.reference.flood_zones.zone_drive`."""
    _zone_drive.launch(phase.shape[0], position, phase, zone_box, zone_normal, zone_speed, velocity)
