"""APIC particles that enter with a layer of nodes. Slime spec S1."""

import numpy as np


def emit_apic(
    inflow_position, inflow_velocity, inflow_mass, apic_offset, first, count, slot, lag,
    apic_phase, apic_position, apic_velocity, apic_affine, apic_mass, apic_strain,
):
    """Write the APIC particles of nodes first to first + count - 1 of the layer: node first + k gets slots
    slot + k m to slot + k m + m - 1, m = number of offsets, each with 1/m of its mass, without spin or strain.

    Reads: inflow_position (3, inlet) [m], inflow_velocity (3, inlet) [m/s], inflow_mass (inlet,) [kg] of nodes,
        apic_offset (3, m) [m] from the node; lag [s]: how long ago the layer passed its position.
    Writes: apic_phase (P,), apic_position (3, P) [m], apic_velocity (3, P) [m/s], apic_affine (9, P) [1/s],
        apic_mass (P,) [kg], apic_strain (6, P) (none without elasticity: length 0) of these slots.
    """
    m = apic_offset.shape[1]
    for k in range(count):
        for o in range(m):
            p, i = slot + k * m + o, first + k
            v = inflow_velocity[:, i].astype(np.float64)
            apic_phase[p] = 0
            apic_position[:, p] = inflow_position[:, i] + float(lag) * v + apic_offset[:, o].astype(np.float64)
            apic_velocity[:, p] = v
            apic_affine[:, p] = 0
            apic_mass[p] = float(inflow_mass[i]) / m
            if apic_strain.shape[1]:
                apic_strain[:, p] = [1, 1, 1, 0, 0, 0]
