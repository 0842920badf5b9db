"""Walls around the domain, on its lattice."""

import math

import numpy as np

from melt.geometry.shapes import affordable
from melt.scene.domain import SIDES


def wall_cells(domain):
    """Return the cells (3, n) of the walls: layers outside of each walled side, edges and corners filled."""
    layers, sides = domain.walls.layers, domain.walls.sides
    if not sides:
        return np.zeros((3, 0), np.int64)
    affordable(math.prod(float(c) + 2 * layers for c in domain.cells), "domain with walls")
    cells = np.array(domain.cells)
    index = np.indices(cells + 2 * layers).reshape(3, -1) - layers
    outside = np.zeros(index.shape[1], dtype=bool)
    allowed = np.ones(index.shape[1], dtype=bool)
    for k, side in enumerate(SIDES):
        axis = k // 2
        beyond = index[axis] < 0 if k % 2 == 0 else index[axis] >= cells[axis]
        outside |= beyond
        if side not in sides:
            allowed &= ~beyond
    if domain.walls.height is not None and "z+" not in sides:
        allowed &= index[2] < int(np.ceil(domain.walls.height / domain.spacing - 1e-6))
    index = index[:, outside & allowed]
    return index[:, np.lexsort((index[0], index[1], index[2]))]


def beyond_walls(cells, domain):
    """Return {side: number of cells that lie beyond that walled side of the domain}."""
    size = np.array(domain.cells)
    found = {}
    for side in domain.walls.sides:
        axis = SIDES.index(side) // 2
        beyond = cells[axis] < 0 if side.endswith("-") else cells[axis] >= size[axis]
        if beyond.any():
            found[side] = int(beyond.sum())
    return found
