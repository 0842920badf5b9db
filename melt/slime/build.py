"""Initial arrays of incompressible liquids: flow fields, disorder, APIC particles, nozzles, moving bodies. Slime spec 4."""

import numpy as np

from melt.constants import calibration
from melt.errors import GeometryError
from melt.physics.phases import DRIVEN, INACTIVE, LIQUID, SOLID, WALL


def disturb(scene, arrays):
    """Shift the liquid's particles at random by ``fluid.jitter`` spacings at most, and give them the flow of ``fluid.flow``."""
    liquid = arrays["phase"] == LIQUID
    flat = scene.domain.dimensions == 2
    if scene.fluid.jitter > 0:
        shift = np.random.default_rng(scene.fluid.seed).uniform(-1, 1, (3, int(liquid.sum()))) * scene.fluid.jitter * scene.spacing
        if flat:
            shift[1] = 0.0
        arrays["position"][:, liquid] += shift
    if scene.fluid.flow is not None:
        arrays["velocity"][:, liquid] += flow(scene.fluid.flow, arrays["position"][:, liquid])


def flow(q, x):
    """Return the velocity (3, n) [m/s] of a `melt.scene.slime.Flow` at x (3, n)."""
    d = x - np.array(q.centre, float)[:, None]
    v = np.zeros_like(d)
    if q.kind == "rotation":
        v[0], v[2] = q.rate * d[2], -q.rate * d[0]
    elif q.kind == "stretch":
        v[0], v[2] = q.rate * d[0], -q.rate * d[2]
    else:
        k = 2 * np.pi / q.length
        v[0], v[2] = np.cos(k * d[0]) * np.sin(k * d[2]), -np.sin(k * d[0]) * np.cos(k * d[2])
        v *= q.rate / k
    return v


def flow_gradient(q, x):
    """Return its gradient dv_a/dx_b (9, n), row by row [1/s], by central differences."""
    step = 1e-6 * max(q.length, 1e-3)
    columns = [(flow(q, x + step * e[:, None]) - flow(q, x - step * e[:, None])) / (2 * step) for e in np.eye(3)]
    return np.stack([columns[b][a] for a in range(3) for b in range(3)])


def apic_offsets(scene):
    """Return the places (3, k) of a node's APIC particles relative to it: a sub-lattice of its cell."""
    per, d = scene.solver.apic.per_axis, scene.spacing
    axis = (np.arange(per) + 0.5) / per - 0.5
    y = np.zeros(1) if scene.domain.dimensions == 2 else axis
    grid = np.stack(np.meshgrid(axis, y, axis, indexing="ij")).reshape(3, -1)
    return d * grid


def apic_arrays(scene, arrays, spare):
    """Return the arrays ``apic_*``: ``spare`` inactive slots for what enters stand behind the rest."""
    q, fluid = scene.solver.apic, scene.fluid
    liquid = np.flatnonzero(arrays["phase"] == LIQUID)
    offset = apic_offsets(scene)
    k, n = offset.shape[1], len(liquid) * offset.shape[1]
    x = (arrays["position"][:, liquid, None] + offset[:, None, :]).reshape(3, n)
    shift = np.random.default_rng(q.seed).uniform(-1, 1, x.shape) * q.jitter * scene.spacing
    if scene.domain.dimensions == 2:
        shift[1] = 0.0
    x += shift
    v = np.repeat(arrays["velocity"][:, liquid], k, axis=1)
    C = np.zeros((9, n))
    if fluid.flow is not None:
        v += flow(fluid.flow, x) - np.repeat(flow(fluid.flow, arrays["position"][:, liquid]), k, axis=1)
        C = flow_gradient(fluid.flow, x)
    total = n + spare * k
    b = np.zeros((6, total))
    b[:3] = 1.0
    return {
        "apic_id": np.arange(total, dtype=np.int32),
        "apic_phase": np.where(np.arange(total) < n, LIQUID, INACTIVE).astype(np.int32),
        "apic_position": np.hstack([x, np.zeros((3, total - n))]),
        "apic_velocity": np.hstack([v, np.zeros((3, total - n))]),
        "apic_affine": np.hstack([C, np.zeros((9, total - n))]),
        "apic_mass": np.concatenate([np.repeat(arrays["mass"][liquid] / k, k), np.zeros(total - n)]),
        "apic_strain": b,
        "apic_offset": offset,
    }


def nozzle_arrays(scene):
    """Return ``nozzle_place`` (8, k) and ``nozzle_speed`` (k,); a nozzle that holds nothing has a negative length."""
    place, speed = np.zeros((8, len(scene.inflow))), np.zeros(len(scene.inflow))
    for k, nozzle in enumerate(scene.inflow):
        axis = np.array(nozzle.direction, float) / np.linalg.norm(nozzle.direction)
        length = (nozzle.hold + 1.0) * scene.spacing if nozzle.hold > 0 else -1.0  # a layer may enter up to a spacing further in
        place[:, k] = [*nozzle.position, *axis, length, nozzle.radius + 0.5 * scene.spacing]
        speed[k] = nozzle.speed
    return {"nozzle_place": place, "nozzle_speed": speed}


def slime_arrays(scene, arrays, moving, spare):
    """Return and change the arrays of an incompressible scene; ``moving`` are slices of particles, one per moving body."""
    disturb(scene, arrays)
    solid = np.isin(arrays["phase"], (WALL, SOLID))
    arrays["rest_volume"][solid] /= calibration(scene)
    driver = np.full(arrays["phase"].size, -1, np.int32)
    for number, body in enumerate(moving):
        arrays["phase"][body], driver[body] = DRIVEN, number
    found = {"driver": driver, **nozzle_arrays(scene)}
    if scene.solver.apic is not None:
        found.update(apic_arrays(scene, arrays, spare))
    return found


def spare_nodes(scene, nodes):
    """Return how many slots to keep for nodes that orphaned APIC particles get: a fiftieth of the nodes, at least 16."""
    return 0 if scene.solver.apic is None else max(16, nodes // 50)


def in_plane(cells, scene, name):
    """Return the cells (3, n) of the plane of a two-dimensional scene; all in three dimensions."""
    if scene.domain.dimensions == 3:
        return cells
    cells = cells[:, cells[1] == 0]
    if not cells.shape[1]:
        raise GeometryError(f"{name}: does not meet y = 0, the plane of a scene with domain.dimensions = 2: move it")
    return cells
