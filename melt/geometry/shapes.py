"""Shapes as cells of the one lattice of the domain (cell i has its centre at lower + (i + 1/2) dx)."""

import numpy as np

from melt.errors import GeometryError
from melt.geometry import mesh

_OFFSET = 1 << 20  # cells fit into 21 bits each
MOST_CELLS = 100_000_000  # of one shape, of the domain's box, of all particles; more is a slip of the pen


def sample(placed, domain, name, notes):
    """Return the cells (3, n) of a `melt.scene.bodies.Placed`, bottom layer first.

    Boxes are moved to the lattice; a move or a rounded edge adds a sentence to ``notes``.

    Raises:
        GeometryError: the shape holds no cell centre, or its mesh cannot be used.
    """
    lower, dx = np.array(domain.lower), domain.spacing
    if placed.shape == "box":
        cells = _box(placed, lower, dx, name, notes, domain.dimensions == 2)
    elif placed.shape == "mesh":
        cells = _mesh(placed, lower, dx, name, notes)
    else:
        cells = _round(placed, lower, dx, name)
    if cells.shape[1] == 0:
        raise GeometryError(
            f"{name}: no lattice point at spacing {dx:g} m is inside: enlarge it or lower domain.spacing"
        )
    if np.abs(cells).max() >= _OFFSET:
        raise GeometryError(
            f"{name}: more than {_OFFSET} spacings away from domain.lower: move it or raise domain.spacing"
        )
    return cells[:, np.lexsort((cells[0], cells[1], cells[2]))]


def affordable(count, name, spacing="domain.spacing"):
    """Refuse to sample more than `MOST_CELLS` cells, before anything is allocated.

    Raises:
        GeometryError: names what is too large.
    """
    if not count <= MOST_CELLS:
        raise GeometryError(
            f"{name}: {float(count):.3g} lattice cells, more than the {MOST_CELLS:,} that fit: check its size (m), "
            f"or raise {spacing}"
        )


def keys(cells):
    """Return one integer per cell (3, n), equal only for equal cells."""
    x, y, z = cells.astype(np.int64) + _OFFSET
    return (z << 42) | (y << 21) | x


def _box(placed, lower, dx, name, notes, flat):
    if placed.lower is not None:
        start, size = np.array(placed.lower), np.subtract(placed.upper, placed.lower)
    else:
        size = np.array(placed.size)
        start = np.array(placed.position) - 0.5 * size
        if placed.anchor == "base":
            start[2] = placed.position[2]
    if flat:  # the plane of a two-dimensional scene, whatever the box is across it
        start[1], size[1] = lower[1], dx
    affordable(np.prod(size / dx), name)
    count = np.maximum(np.floor(size / dx + 0.5), 1).astype(np.int64)
    if (np.abs(count * dx - size) > 1e-3 * dx).any():
        notes.append(f"{name}: edges {_metres(size)} m rounded to {_metres(count * dx)} m, whole spacings")
    first = np.floor((start - lower) / dx + 0.5 + 1e-9).astype(np.int64)
    moved = lower + first * dx - start
    if (np.abs(moved) > 1e-3 * dx).any():
        notes.append(f"{name}: moved by {_metres(moved)} m to the lattice")
    return first[:, None] + np.stack([g.ravel() for g in np.indices(count)])


def _round(placed, lower, dx, name):
    """Sphere or cylinder: cells whose centre is inside (surface included)."""
    half = np.full(3, placed.radius)
    flat = {"x": 0, "y": 1, "z": 2}[placed.axis or "z"]
    if placed.shape == "cylinder":
        half[flat] = 0.5 * placed.height
    centre = (np.array(placed.position) - lower) / dx - 0.5
    if placed.anchor == "base":
        centre[2] += half[2] / dx
    radius = half / dx
    affordable(np.prod(2 * radius), name)
    first = np.ceil(centre - radius - 1e-9).astype(np.int64)
    count = np.maximum(np.floor(centre + radius + 1e-9).astype(np.int64) - first + 1, 0)
    cells = first[:, None] + np.stack([g.ravel() for g in np.indices(count)])
    q = (cells - centre[:, None]) / radius[:, None]
    if placed.shape == "cylinder":
        q[flat] = 0.0
    return cells[:, (q**2).sum(axis=0) <= 1 + 1e-9]


def _mesh(placed, lower, dx, name, notes):
    vertices, triangles = mesh.read_mesh(placed.file, bool(placed.repair))
    if placed.rotate is not None:
        vertices = vertices @ mesh.rotation_matrix(placed.rotate).T
        vertices -= 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    position = (np.array(placed.position) - lower) / dx

    def place(points):
        lift = -points[:, 2].min() if placed.anchor == "base" else 0.0
        return points + position + [0.0, 0.0, lift]

    affordable(placed.particles or np.prod(np.ptp(vertices, axis=0) * (placed.scale or 1.0) / dx), name)
    if placed.particles is None:
        return mesh.voxelise(place(vertices * ((placed.scale or 1.0) / dx)), triangles)
    cells, scale = mesh.voxelise_to_count(vertices, triangles, place, placed.particles)
    notes.append(
        f"{name}: scale {scale * dx:.6g} gives {cells.shape[1]} particles ({placed.particles} wanted)"
    )
    return cells


def _metres(values):
    return " x ".join(f"{v + 0.0:.4g}" for v in values)
