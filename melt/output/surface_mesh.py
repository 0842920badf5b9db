"""Surfaces of particles as triangle meshes: Zhu-Bridson field, marching cubes. Melting spec 2.8."""

import importlib
from typing import NamedTuple

import numpy as np
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skimage.measure import marching_cubes

from melt import backend as backends
from melt import params

MOST_NODES = 150_000_000  # of the box around the particles; about 600 MB


class Mesh(NamedTuple):
    """A closed surface; faces wind counter-clockwise seen from outside."""

    vertices: np.ndarray  # (v, 3) [m]
    faces: np.ndarray  # (f, 3)
    normals: np.ndarray  # (v, 3), pointing out
    temperature: np.ndarray  # (v,) [degC], length 0 without

    def volume(self):
        """Return the enclosed volume [m^3]."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


EMPTY = Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 3)), np.zeros(0))


def spacing_of(position):
    """Return the particle spacing dx [m]: the median distance of nearest neighbours."""
    if len(position) < 2:
        return 1.0
    some = position if len(position) < 20000 else position[:: len(position) // 20000 + 1]
    distance = cKDTree(position).query(some, k=2)[0][:, 1]
    return float(np.median(distance)) or 1.0


def reconstruct(
    position, temperature=None, spacing=None, reach=2.0, radius=0.6, node=0.5, correct=True, backend="cpu"
):
    """Return the `Mesh` around particles; lengths in units of the spacing.

    Args:
        position: (n, 3) [m]. temperature: (n,) [degC] or None.
        reach: R of the weights. radius: r, by which the surface lies outside of the mean.
        node: distance of grid nodes; the cost goes with its third power.
        correct: eigenvalue correction, which removes sheets between parts that approach.
        backend: name of a `melt.backend`.
    """
    position = np.asarray(position)
    position = position[np.isfinite(position).all(axis=1)] if temperature is None else position
    if len(position) == 0:
        return EMPTY
    dx = spacing or spacing_of(position)
    R = reach * dx
    cells = _Cells(position, temperature, R, max(1, round(reach / node)))
    tuple_ = params.make(
        params.Reconstruction,
        np.float32,
        reach=R,
        radius=radius * dx,
        correct=correct,
        temperature=temperature is not None,
    )
    phi = cells.field(tuple_, dx, backend)
    vertices, faces, normals, _ = marching_cubes(phi, 0.0, gradient_direction="ascent")
    # neighbours of a vertex in float32 nodes: back to metres in float64
    mesh = Mesh(
        cells.origin + vertices.astype(np.float64) * cells.step, faces.astype(np.int64), normals, np.zeros(0)
    )
    if mesh.volume() < 0:
        mesh = mesh._replace(faces=mesh.faces[:, ::-1])
    T = cells.evaluate(mesh.vertices.T, tuple_, backend)[1] if temperature is not None else np.zeros(0)
    return mesh._replace(normals=_normals(mesh), temperature=T)


def components(position, temperature=None, spacing=None, bond=1.45, **options):
    """Return one `Mesh` per piece of solid; particles closer than ``bond`` spacings belong together."""
    position = np.asarray(position)
    if len(position) == 0:
        return []
    dx = spacing or spacing_of(position)
    pairs = cKDTree(position).query_pairs(bond * dx, output_type="ndarray")
    links = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(position),) * 2)
    count, label = connected_components(links, directed=False)
    order = np.argsort(label, kind="stable")
    pieces = np.split(order, np.cumsum(np.bincount(label, minlength=count))[:-1])
    options = {"correct": False, **options}
    found = (
        reconstruct(position[p], None if temperature is None else temperature[p], dx, **options)
        for p in pieces
    )
    return [mesh for mesh in found if len(mesh.faces)]


def join(meshes):
    """Return several meshes as one."""
    meshes = list(meshes)
    if not meshes:
        return EMPTY
    shift = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.faces + s for m, s in zip(meshes, shift)]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.temperature for m in meshes]),
    )


def _normals(mesh):
    """Return vertex normals: the mean of the face normals, weighted by area."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros_like(mesh.vertices)
    for axis in range(3):
        for corner in range(3):
            total[:, axis] += np.bincount(mesh.faces[:, corner], face[:, axis], len(total))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return total / np.where(length > 0, length, 1)


class _Cells:
    """Particles in cells of edge R, with ``ratio`` nodes per edge, in a frame of their own."""

    def __init__(self, position, temperature, R, ratio):
        low, high = position.min(axis=0), position.max(axis=0)
        if np.prod((high - low) / R + 5) * ratio**3 > MOST_NODES:  # a few far splashes blow the box up
            low, high = (np.quantile(position, q, axis=0) for q in (0.001, 0.999))
            low, high = low - 10 * R, high + 10 * R
            keep = ((position >= low) & (position <= high)).all(axis=1)
            position = position[keep]
            temperature = temperature[keep] if temperature is not None else None
            low, high = position.min(axis=0), position.max(axis=0)
        self.origin = low.astype(np.float64) - 2 * R
        self.counts = np.ceil((high - self.origin) / R).astype(int) + 2
        self.ratio, self.step, self.R = ratio, R / ratio, R
        # float32 holds positions relative to the box, wherever it is
        local = (position - self.origin).astype(np.float32)
        where = np.minimum((local * np.float32(1 / R)).astype(int), self.counts - 1)
        linear = where[:, 0] + self.counts[0] * (where[:, 1] + self.counts[1] * where[:, 2])
        order = np.argsort(linear, kind="stable")
        total = int(np.prod(self.counts))
        number = np.bincount(linear, minlength=total + 1)
        self.cell_start = np.concatenate([[0], np.cumsum(number)]).astype(np.int32)
        self.number = number[:total].reshape(self.counts[::-1]).transpose(2, 1, 0)
        self.position = np.ascontiguousarray(local[order].T)
        self.temperature = (
            np.zeros(0, np.float32) if temperature is None else temperature[order].astype(np.float32)
        )
        nx, ny, nz = map(int, self.counts)
        self.grid = params.make(
            params.Grid,
            np.float32,
            origin_x=0.0,
            origin_y=0.0,
            origin_z=0.0,
            inverse_cell=1 / R,
            nx=nx,
            ny=ny,
            nz=nz,
        )

    def evaluate(self, points, reconstruction, backend):
        """Return (field [m], temperature [degC]) at points (3, m) [m]."""
        return self._local((points - self.origin[:, None]).astype(np.float32), reconstruction, backend)

    def _local(self, nodes, reconstruction, backend):
        there = backends.load(backend)
        stage = importlib.import_module(f"melt.{there.folder}.surface_field").surface_field
        distance, temperature = (there.upload(np.empty(nodes.shape[1], np.float32)) for _ in range(2))
        given = (there.upload(a) for a in (self.position, self.temperature, self.cell_start, nodes))
        stage(*given, self.grid, reconstruction, distance, temperature)
        return there.download(distance), there.download(temperature)

    def field(self, reconstruction, dx, backend):
        """Return the field on all nodes, computed in the band around the surface only."""
        r = np.float32(reconstruction.radius)
        box = np.ones((3, 3, 3))
        near = ndimage.binary_dilation(self.number > 0, box)
        # deep inside, no cell around lacks more than a quarter of its particles
        full = 0.75 * (self.R / dx) ** 3
        deep = ndimage.minimum_filter(self.number, 3, mode="constant") >= full
        phi = np.full(self.counts * self.ratio + 1, r, np.float32)
        inner = phi[:-1, :-1, :-1]
        for axis in range(3):
            near, deep = np.repeat(near, self.ratio, axis), np.repeat(deep, self.ratio, axis)
        inner[deep] = -r
        band = np.argwhere(near & ~deep)
        nodes = (band.T * np.float32(self.step)).astype(np.float32)
        value = self._local(nodes, reconstruction, backend)[0]
        value[value == 0] = np.float32(1e-6) * r  # a node exactly on the surface makes degenerate triangles
        inner[tuple(band.T)] = value
        return phi
