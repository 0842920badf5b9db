"""CPU twin of `melt.reference.flood_zones`."""

from melt._compile import cpu_stage, prange
from melt.physics.flood_motion import inside_box
from melt.physics.phases import LIQUID


@cpu_stage
def zone_sums(position, velocity, phase, rest_volume, depth, zone_probe, zone_normal, zone_sums):
    """See `melt.reference.flood_zones.zone_sums`."""
    for z in prange(zone_sums.shape[1]):
        n_x, n_y = zone_normal[0, z], zone_normal[1, z]
        x_from, x_to, y_from, y_to = zone_probe[0, z], zone_probe[1, z], zone_probe[2, z], zone_probe[3, z]
        area = flow = volume = 0.0
        for i in range(phase.shape[0]):
            if phase[i] == LIQUID and inside_box(position[0, i], position[1, i], x_from, x_to, y_from, y_to):
                V = rest_volume[i]
                area += V / depth[i]
                flow += V * (n_x * velocity[0, i] + n_y * velocity[1, i])
                volume += V
        zone_sums[0, z], zone_sums[1, z], zone_sums[2, z] = area, flow, volume


@cpu_stage
def zone_drive(position, phase, zone_box, zone_normal, zone_speed, velocity):
    """See `melt.reference.flood_zones.zone_drive`."""
    zones = zone_speed.shape[0]
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            continue
        x, y = position[0, i], position[1, i]
        for z in range(zones):
            speed = zone_speed[z]
            if speed == speed and inside_box(x, y, zone_box[0, z], zone_box[1, z], zone_box[2, z], zone_box[3, z]):
                velocity[0, i], velocity[1, i] = speed * zone_normal[0, z], speed * zone_normal[1, z]
                break
