"""Inflow: nozzles emit whole layers of liquid. Melting spec, stage 0."""

import numpy as np


def emit_motion(inflow_position, inflow_velocity, first, count, slot, lag, phase, position, velocity, latent_energy):
    """Layer of new particles: rows first..first+count of the inflow table into the slots from ``slot``.

    Reads: inflow_position (3, inlets) [m], inflow_velocity (3, inlets) [m/s]; ``lag`` [s] since the layer
        should have entered, by which it has moved on.
    Writes: phase, position (3, n) [m], velocity (3, n) [m/s], latent_energy (length 0 without latent heat) of
        those slots.
    """
    rows, slots = slice(first, first + count), slice(slot, slot + count)
    phase[slots] = 0
    if latent_energy.size:  # all that fits, as in `latent_start`: it is liquid
        latent_energy[slots] = np.inf
    velocity[:, slots] = inflow_velocity[:, rows]
    position[:, slots] = inflow_position[:, rows] + lag * inflow_velocity[:, rows]


def emit_matter(
    inflow_mass, inflow_volume, inflow_temperature, inflow_material, first, count, slot,
    mass, rest_volume, temperature, material, site,
):
    """Matter of the new particles of `emit_motion`.

    Reads: inflow_mass [kg], inflow_volume [m^3], inflow_temperature [degC], inflow_material, all (inlets,).
    Writes: mass, rest_volume, temperature (length 0 in a scene without heat), material, site (-1;
        length 0 in a scene without solids) of the slots.
    """
    rows, slots = slice(first, first + count), slice(slot, slot + count)
    mass[slots] = inflow_mass[rows]
    rest_volume[slots] = inflow_volume[rows]
    material[slots] = inflow_material[rows]
    if site.size:
        site[slots] = -1
    if temperature.size:
        temperature[slots] = inflow_temperature[rows]
