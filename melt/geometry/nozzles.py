"""Round nozzles: one layer of a square lattice, emitted every spacing / speed seconds."""

import math
from typing import NamedTuple

import numpy as np

from melt.errors import GeometryError


class Nozzle(NamedTuple):
    """When a nozzle emits, and which rows of the ``inflow_*`` arrays are its layer."""

    name: str
    start: float  # [s]
    interval: float  # between layers [s]
    layers: int
    count: int  # particles per layer
    first: int  # its first row


def nozzle_table(scene):
    """Return (list of `Nozzle`, arrays ``inflow_*``)."""
    dx, density = scene.spacing, scene.fluid.density
    nozzles, positions, velocities, temperatures, first = [], [], [], [], 0
    for inflow in scene.inflow:
        points = disc(inflow.radius, inflow.direction, dx)
        if scene.domain.dimensions == 2:
            points = points[:, np.abs(points[1]) < 1e-6 * dx]
        axis = np.array(inflow.direction) / math.hypot(*inflow.direction)
        points = points + (np.array(inflow.position) - inflow.hold * dx * axis)[:, None]  # the inner end of the nozzle
        count = points.shape[1]
        if count == 0:
            raise GeometryError(f"inflow {inflow.name!r}: its radius {inflow.radius:g} m holds no particle")
        nozzles.append(Nozzle(inflow.name, inflow.start, dx / inflow.speed, inflow.layers, count, first))
        positions.append(points)
        velocities.append(np.repeat(inflow.speed * axis[:, None], count, axis=1))
        temperatures.append(
            np.full(count, scene.fluid.temperature if inflow.temperature is None else inflow.temperature)
        )
        first += count
    arrays = {
        "inflow_position": np.hstack(positions) if positions else np.zeros((3, 0)),
        "inflow_velocity": np.hstack(velocities) if positions else np.zeros((3, 0)),
        "inflow_mass": np.full(first, density * scene.particle_volume),
        "inflow_volume": np.full(first, scene.particle_volume),
        "inflow_temperature": np.concatenate(temperatures) if positions else np.zeros(0),
        "inflow_material": np.zeros(first, np.int32),
    }
    return nozzles, arrays


def disc(radius, direction, dx):
    """Return lattice points (3, n) of a disc around the origin, square to ``direction``."""
    axis = np.array(direction, float) / math.hypot(*direction)
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(axis, helper)
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    reach = int(radius / dx + 1e-9)
    i, j = np.indices((2 * reach + 1, 2 * reach + 1)).reshape(2, -1) - reach
    inside = (i**2 + j**2) * dx**2 <= radius**2 * (1 + 1e-9)
    return dx * (first[:, None] * i[inside] + second[:, None] * j[inside])
