"""Initial state of a flood: terrain, walls, columns of water, points of maps and gauges."""

from dataclasses import dataclass, field

import numpy as np

from melt.errors import GeometryError
from melt.flood import pools, walls
from melt.flood.bed import bed_at
from melt.flood.plan import grid_values
from melt.flood.sources import Sources
from melt.geometry.build import Initial
from melt.geometry.shapes import affordable
from melt.geometry.terrain import TerrainGrid, load_terrain
from melt.geometry.terrain_zones import manning_grid
from melt.physics.phases import AIRBORNE, INACTIVE, LIQUID

ENTRY_ROWS = 1024  # columns that may enter at once


@dataclass
class FloodInitial(Initial):
    """Arrays of a flood at t = 0 in the terrain's local frame, and what else the run needs to know."""

    terrain: TerrainGrid = None
    sources: Sources = None
    map_nodes: int = 0  # points of `sample_position` that are the nodes of the terrain; gauges follow
    entry_rows: int = ENTRY_ROWS
    pools: list = field(default_factory=list)


def build_flood(scene):
    """Return the `FloodInitial` of a `melt.scene.flood.FloodScene`.

    Raises:
        GeometryError: the terrain cannot be read, or something lies outside of it.
    """
    terrain = load_terrain(scene.terrain)
    notes = list(terrain.notes)
    low, high = (np.array([*corner, z]) for corner, z in zip(terrain.bounds, (0.0, float(terrain.elevation.max()))))
    outlines = walls.local_outlines(scene, terrain)
    arrays = walls.boundary_fields(scene, terrain, outlines)
    arrays["terrain"] = terrain.elevation.ravel()
    distance = walls.wall_distance(terrain, outlines)
    arrays["terrain_wall"] = distance.ravel()
    if scene.friction is not None and (scene.friction.zone or scene.friction.raster):
        arrays["terrain_friction"] = manning_grid(scene.friction, terrain).ravel().astype(float)
    boundary = walls.as_boundary(arrays)
    x, volume, depth, velocity = pools.columns(scene, terrain, outlines, distance, boundary, notes)
    sources = Sources(scene, terrain)
    spare = spare_slots(scene, x.shape[1], sources)
    affordable(x.shape[1] + spare, "columns (at the start and to come)")
    arrays.update(_columns(scene, terrain, x, volume, depth, velocity, spare))
    nodes, samples = _samples(scene, terrain)
    arrays.update(samples)
    arrays.update(sources.zone_fields())
    initial = FloodInitial(
        arrays, scene.spacing, low, high, [], [], [], notes, terrain=terrain, sources=sources, map_nodes=nodes,
    )
    walls.sort_boundary(arrays, grid_values(scene, initial))
    return initial


def spare_slots(scene, start, sources):
    """Return how many columns there is to be room for beside those at the start."""
    if not (scene.inflow or scene.edge or scene.rain):
        return 0
    if scene.fluid.capacity is not None:
        return max(0, scene.fluid.capacity - start)
    expected = sources.expected_volume(scene.time.end) / scene.column_volume
    return int(1.5 * expected) + 2 * ENTRY_ROWS


def _columns(scene, terrain, x, volume, depth, velocity, spare):
    """Arrays over columns; free slots stand at the domain's corner: no stage reads their place."""
    n, fluid, s = x.shape[1], scene.fluid, scene.solver
    total = n + spare
    bed = bed_at(terrain, *x, scene.terrain.sampler)
    falls = fluid.release_height > 0
    position = np.zeros((3, total))
    position[:2] = terrain.bounds[0][:, None]
    position[:2, :n] = x
    position[2, :n] = bed + (fluid.release_height if falls else depth)
    support = np.clip(s.support * np.sqrt(volume / np.maximum(depth, 1e-9)), *(f * scene.support for f in s.support_limits))
    columns = {
        "phase": AIRBORNE if falls else LIQUID, "rest_volume": volume, "mass": fluid.density * volume, "depth": depth,
        "support_radius": support, "bed": bed,
    }
    free = {"phase": INACTIVE, "support_radius": scene.support}
    arrays = {"id": np.arange(total, dtype=np.int32), "position": position, "position_before": position.copy()}
    for name, values in columns.items():
        arrays[name] = np.full(total, free.get(name, 0), np.int32 if name == "phase" else float)
        arrays[name][:n] = values
    arrays["velocity"] = np.zeros((3, total))
    arrays["velocity"][:2, :n] = velocity
    arrays["brake"] = np.zeros(total)
    return arrays


def _blocked(terrain, place):
    """Return whether the node nearest to a local place is one that water may not enter."""
    row, column = (np.clip(int(k), 0, n - 1) for k, n in zip(terrain.node(place), terrain.shape))
    return bool(terrain.blocked[row, column])


def _samples(scene, terrain):
    """Return (nodes of the map, arrays over sample points): nodes of the terrain, then gauges."""
    x = np.zeros((2, 0))
    if scene.output.maps:
        x = np.stack([a.ravel() for a in np.meshgrid(terrain.x, terrain.y)])
    nodes = x.shape[1]
    gauges = [terrain.local(gauge.position) for gauge in scene.gauge]
    for gauge, place in zip(scene.gauge, gauges):
        if _blocked(terrain, place):
            where = f"at {list(gauge.position)} stands on blocked ground (no elevation, or a wall)"
            raise GeometryError(f"gauge {gauge.name!r} {where}: move it")
        if not ((place >= terrain.bounds[0]) & (place <= terrain.bounds[1])).all():
            where = f"at {list(gauge.position)} lies outside of the terrain, {walls.extent(terrain)}"
            raise GeometryError(f"gauge {gauge.name!r} {where}: move it, or widen the terrain")
    x = np.hstack([x, *[g[:, None] for g in gauges]])
    count = x.shape[1]
    zero = np.zeros(count)
    return nodes, {
        "sample_position": x, "sample_bed": bed_at(terrain, *x, scene.terrain.sampler), "arrival_time": np.full(count, -1.0),
        **{name: zero for name in ("most_depth", "most_speed", "most_flux", "wet_time")},
    }
