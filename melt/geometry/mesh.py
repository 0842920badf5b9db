"""Triangle meshes as lattice cells: reading, watertightness, voxels, a wanted particle count.

Inside is decided by winding: along each column of cells the triangles crossed from below are summed
with their sign, so overlapping closed parts count as one body. (trimesh's ray queries answer the same
question point by point; a column at a time is some thousand times faster and needs no rtree.)
"""

import pathlib

import numpy as np

from melt.errors import GeometryError
from melt.paths import is_file
from melt.scene.load import data_folder

COUNT_TOLERANCE = 0.02  # of a wanted particle count (melting spec, scene F6)


def find_mesh(name):
    """Return the path of a mesh: a file, or a shipped one by its name."""
    for path in (
        pathlib.Path(name),
        data_folder() / "meshes" / name,
        data_folder() / "meshes" / f"{name}.ply",
    ):
        if is_file(path):
            return path
    shipped = ", ".join(sorted(p.stem for p in (data_folder() / "meshes").glob("*.ply")))
    raise GeometryError(
        f"mesh file {name!r} does not exist: give a path (relative to the scene file) or one of {shipped}"
    )


def read_mesh(name, repair=False):
    """Return (vertices (n, 3), triangles (k, 3)) of a closed mesh, centred on its bounding box.

    Raises:
        GeometryError: not found, not readable, without triangles, or not watertight.
    """
    import trimesh

    path = find_mesh(name)
    try:
        mesh = trimesh.load(path, force="mesh", process=True)
    except Exception as error:  # trimesh raises many kinds, all mean that the file is no mesh
        raise GeometryError(
            f"mesh {path.name}: cannot be read ({error}); PLY, OBJ, STL and glTF work"
        ) from None
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise GeometryError(f"mesh {path.name}: it has no triangles; PLY, OBJ, STL and glTF with faces work")
    if not np.isfinite(mesh.vertices).all():
        raise GeometryError(f"mesh {path.name}: a vertex is not finite; export it again")
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    if repair and not mesh.is_watertight:
        mesh = _closed(mesh)
    if not mesh.is_watertight:
        edges = np.sort(mesh.edges, axis=1)
        open_edges = int((np.unique(edges, axis=0, return_counts=True)[1] != 2).sum())
        advice = (
            "repair it in a mesh editor" if repair else "set repair = true, or repair it in a mesh editor"
        )
        raise GeometryError(
            f"mesh {path.name}: not watertight ({open_edges} edges without exactly two faces): {advice}"
        )
    low, high = mesh.bounds
    if (high - low).min() <= 0:
        raise GeometryError(f"mesh {path.name}: it is flat, a body needs a volume")
    return np.asarray(mesh.vertices, dtype=float) - 0.5 * (low + high), np.asarray(mesh.faces)


def _closed(mesh):
    """Return ``mesh`` with each hole closed by a fan of triangles, and wound outwards."""
    import trimesh

    faces, vertices = trimesh.repair.stitch(mesh, insert_vertices=True)
    closed = trimesh.Trimesh(
        np.vstack([mesh.vertices, vertices]) if len(vertices) else mesh.vertices,
        np.vstack([mesh.faces, faces]) if len(faces) else mesh.faces,
    )
    trimesh.repair.fix_normals(closed)
    return closed


def rotation_matrix(degrees):
    """Return the matrix of rotations about x, then y, then z."""
    matrix = np.eye(3)
    for axis, angle in enumerate(np.radians(degrees)):
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[[i, j], [i, j]] = np.cos(angle)
        turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
        matrix = turn @ matrix
    return matrix


def voxelise(vertices, triangles):
    """Return the cells (3, n) whose centres (i + 1/2) lie inside a closed mesh; lengths in spacings."""
    low = np.floor(vertices.min(axis=0)).astype(np.int64) - 1
    shape = np.ceil(vertices.max(axis=0)).astype(np.int64) + 1 - low
    # columns run through cell centres, moved by a tiny odd amount so that none meets an edge or vertex
    corner = (vertices - low - 0.5 - np.array([1.2345e-6, 2.7182e-6, 0.0]))[triangles]
    first = np.maximum(np.ceil(corner[:, :, :2].min(axis=1)), 0).astype(np.int64)
    last = np.minimum(np.floor(corner[:, :, :2].max(axis=1)), shape[:2] - 1).astype(np.int64)
    columns = np.maximum(last - first + 1, 0)
    count = columns[:, 0] * columns[:, 1]
    face = np.repeat(np.arange(len(triangles)), count)
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    x = first[face, 0] + within % np.maximum(columns[face, 0], 1)
    y = first[face, 1] + within // np.maximum(columns[face, 0], 1)
    a, b, c = corner[face, 0], corner[face, 1], corner[face, 2]
    area = _cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.stack([x - a[:, 0], y - a[:, 1]], axis=1)
        v = _cross(b - a, step) / area  # weight of c
        u = _cross(step, c - a) / area  # weight of b
        hit = (u >= 0) & (v >= 0) & (u + v <= 1)
        z = a[:, 2] + u * (b[:, 2] - a[:, 2]) + v * (c[:, 2] - a[:, 2])
    winding = np.zeros(shape + [0, 0, 1], dtype=np.int32)
    above = np.clip(np.ceil(z[hit]), 0, shape[2]).astype(np.int64)  # first centre above the crossing
    np.add.at(winding, (x[hit], y[hit], above), np.where(area[hit] > 0, -1, 1))
    inside = np.cumsum(winding, axis=2)[:, :, :-1] != 0
    return np.stack(np.nonzero(inside)) + low[:, None]


def _cross(p, q):
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]


def voxelise_to_count(vertices, triangles, place, wanted):
    """Return (cells, scale) with about ``wanted`` cells: the scale is bisected to within 2 %.

    ``place(points)`` moves scaled points to their place, lengths in spacings.

    Raises:
        GeometryError: no scale comes within 2 % (a count too small for the shape).
    """

    def cells_at(scale):
        return voxelise(place(scale * vertices), triangles)

    low, high = 0.0, 1.0 / np.ptp(vertices, axis=0).max()
    while (cells := cells_at(high)).shape[1] < wanted:
        low, high = high, 1.5 * high
    best = (cells, high)
    for _ in range(60):
        scale = 0.5 * (low + high)
        cells = cells_at(scale)
        if abs(cells.shape[1] - wanted) < abs(best[0].shape[1] - wanted):
            best = (cells, scale)
        if best[0].shape[1] == wanted:
            break
        low, high = (scale, high) if cells.shape[1] < wanted else (low, scale)
        if high - low < 1e-9 * high:
            break
    found = best[0].shape[1]
    if abs(found - wanted) > COUNT_TOLERANCE * wanted:
        raise GeometryError(
            f"no scale gives {wanted} particles, the nearest gives {found}: ask for that, or give scale"
        )
    return best
