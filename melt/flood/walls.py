"""Walls and obstacles of a flood: boundary particles, and the distance to what water may not enter. Flood spec E14."""

import dataclasses

import numpy as np

from melt.errors import GeometryError
from melt.flood.bed import bed_at
from melt.geometry import barriers
from melt.geometry.barriers import Boundary
from melt.geometry.outlines import distance, inside

FAR = 1e30  # [m] where there is nothing to keep away from
STEEP = 1e6  # [1] how fast the distance falls into open ground: so deep at once that nothing is pushed back out
SIDES = ("west", "east", "south", "north")


def extent(terrain):
    """Return the extent of a terrain in world coordinates, in words."""
    low, high = terrain.world(terrain.bounds[0]), terrain.world(terrain.bounds[1])
    return f"({low[0]:.10g}, {low[1]:.10g}) to ({high[0]:.10g}, {high[1]:.10g})"


def local_outlines(scene, terrain):
    """Return the obstacles of a scene with their places in local coordinates.

    Raises:
        GeometryError: one lies outside of the terrain.
    """
    found = []
    for k, obstacle in enumerate(scene.obstacle):
        moved = {
            name: terrain.local(np.array(getattr(obstacle, name)).T).T.tolist()
            for name in ("centre", "polygon", "hole")
            if getattr(obstacle, name) is not None
        }
        outline = obstacle.model_copy(update=moved)
        low, high = barriers.corners(outline)
        if (low > terrain.bounds[1]).any() or (high < terrain.bounds[0]).any():
            raise GeometryError(f"obstacle {k} lies outside of the terrain, {extent(terrain)}: move it, or widen the terrain")
        found.append(outline)
    return found


def boundary_fields(scene, terrain, outlines):
    """Return boundary_position (3, b) and boundary_area (b,) of walls, obstacles and blocked ground."""
    b = scene.boundary
    driven = {edge.side for edge in scene.edge}
    sides = [side for side in SIDES if getattr(b, side) == "wall" and side not in driven]
    if not b.columns or not (sides or outlines or terrain.blocked.any()):
        return {"boundary_position": np.zeros((3, 0)), "boundary_area": np.zeros(0)}
    spacing, thick = b.spacing * scene.spacing, b.thickness * scene.support
    parts = []
    for outline in outlines:
        mine = barriers.obstacle_boundary(outline, outline.spacing or spacing, thick)
        parts.append((mine, lambda x, outline=outline: inside(outline, x)))
    if sides:
        parts.append((barriers.rectangle_walls(*terrain.bounds, sides, spacing, thick), None))
    if terrain.blocked.any():
        parts.append((barriers.mask_boundary(terrain.blocked, terrain.bounds[0], terrain.cell, spacing, thick), None))
    found = barriers.union(parts, spacing)
    z = bed_at(terrain, *found.x, scene.terrain.sampler)
    return {"boundary_position": np.vstack([found.x, z]), "boundary_area": found.area}


def as_boundary(arrays):
    """Return the `Boundary` of boundary fields."""
    return Boundary(arrays["boundary_position"][:2], arrays["boundary_area"])


def wall_distance(terrain, outlines):
    """Return the signed distance (ny, nx) [m] of nodes to blocked ground and obstacles; `FAR` without any.

    Open ground (terrain.nodata = open) is a wall without a surface: what enters is taken out by the guard.
    """
    found = np.where(terrain.wall_distance > 1e8, FAR, terrain.wall_distance).astype(float)
    x = np.stack([a.ravel() for a in np.meshgrid(terrain.x, terrain.y)])
    for outline in outlines:
        found = np.minimum(found, _covering(outline, terrain, distance(outline, x).reshape(found.shape)))
    if terrain.open.any():
        ground = dataclasses.replace(terrain, blocked=terrain.open)
        found = np.minimum(found, STEEP * ground.wall_distance.astype(float))
    return found


def _covering(outline, terrain, nodes):
    """Return a distance (ny, nx) at nodes whose bilinear surface nowhere lies inside of an obstacle.

    Between nodes the distance to a straight edge is exact, but a corner is rounded off by up to a fifth of a cell: the
    nodes around it are lowered by what they are too high anywhere in their cells.
    """
    (dx, dy), n = terrain.cell, 8
    low = np.minimum.reduce([nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, :-1], nodes[1:, 1:]])
    j, i = np.nonzero(np.abs(low) < 1.5 * np.hypot(dx, dy))
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1)))
    x = np.stack([terrain.x[i][:, None] + u * dx, terrain.y[j][:, None] + v * dy])
    exact = distance(outline, x.reshape(2, -1)).reshape(len(i), -1)
    corners = [nodes[j + b, i + a][:, None] for b in (0, 1) for a in (0, 1)]
    weights = [(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v]
    between = sum(w * c for w, c in zip(weights, corners))
    high = np.where(exact < 0, between - exact, 0.0).max(axis=1, initial=0.0)
    lowered = np.zeros_like(nodes)
    for b in (0, 1):
        for a in (0, 1):
            np.maximum.at(lowered, (j + b, i + a), high)
    return nodes - lowered


def sort_boundary(arrays, grid):
    """Sort boundary particles by cell of the neighbour grid, and fill boundary_start and boundary_ring.

    boundary_ring of a cell is the ring of cells in which the nearest boundary particle is.
    """
    from scipy.ndimage import distance_transform_cdt

    nx, ny = int(grid["nx"]), int(grid["ny"])
    x = arrays["boundary_position"]
    i = np.clip(np.floor((x[0] - grid["origin_x"]) * grid["inverse_cell"]), 0, nx - 1).astype(np.int64)
    j = np.clip(np.floor((x[1] - grid["origin_y"]) * grid["inverse_cell"]), 0, ny - 1).astype(np.int64)
    cell = i + nx * j
    order = np.argsort(cell, kind="stable")
    arrays["boundary_position"] = np.ascontiguousarray(x[:, order])
    arrays["boundary_area"] = arrays["boundary_area"][order]
    arrays["boundary_start"] = np.searchsorted(cell[order], np.arange(nx * ny + 2)).astype(np.int32)
    taken = np.zeros((ny, nx), bool)
    taken.ravel()[cell] = True
    ring = distance_transform_cdt(~taken, "chessboard") if taken.any() else np.full((ny, nx), 1 << 20)
    arrays["boundary_ring"] = np.concatenate([ring.ravel(), [1 << 20, 1 << 20]]).astype(np.int32)
