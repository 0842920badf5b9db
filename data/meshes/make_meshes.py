"""Make the shipped meshes: rabbit.ply and duck.ply, smooth unions of ellipsoids. Run: python make_meshes.py

Own work, CC0. z is up, the face looks along +x.
"""

import pathlib

import numpy as np
import trimesh
from skimage.measure import marching_cubes

# (centre, half axes, turn about y in degrees) of each ellipsoid
RABBIT = [
    ((0.00, 0.00, 0.55), (0.80, 0.58, 0.55), 12),  # trunk
    ((-0.35, 0.00, 0.50), (0.52, 0.60, 0.50), 0),  # hind quarters
    ((0.62, 0.00, 1.18), (0.40, 0.33, 0.34), 10),  # head
    ((0.90, 0.00, 1.08), (0.18, 0.18, 0.15), 0),  # nose
    ((0.38, 0.20, 1.72), (0.17, 0.13, 0.48), -18),  # ears
    ((0.38, -0.20, 1.72), (0.17, 0.13, 0.48), -18),
    ((-0.92, 0.00, 0.55), (0.22, 0.22, 0.22), 0),  # tail
    ((0.62, 0.28, 0.18), (0.34, 0.16, 0.18), 0),  # fore feet
    ((0.62, -0.28, 0.18), (0.34, 0.16, 0.18), 0),
    ((-0.15, 0.50, 0.18), (0.45, 0.18, 0.18), 0),  # hind feet
    ((-0.15, -0.50, 0.18), (0.45, 0.18, 0.18), 0),
]
DUCK = [
    ((0.00, 0.00, 0.50), (0.95, 0.62, 0.50), 0),  # trunk
    ((-0.80, 0.00, 0.78), (0.42, 0.34, 0.22), 35),  # tail
    ((0.50, 0.00, 0.95), (0.32, 0.30, 0.45), 0),  # neck
    ((0.60, 0.00, 1.38), (0.44, 0.40, 0.40), 0),  # head
    ((1.08, 0.00, 1.32), (0.30, 0.22, 0.10), 6),  # beak
    ((-0.10, 0.55, 0.62), (0.55, 0.16, 0.28), 10),  # wings
    ((-0.10, -0.55, 0.62), (0.55, 0.16, 0.28), 10),
]
SPACING = 0.085
BLEND = 0.12


def level(points, parts):
    """Smooth minimum of the ellipsoids' scaled distances: negative inside."""
    terms = []
    for centre, half, degrees in parts:
        a = np.radians(degrees)
        x, y, z = (points - centre).T
        local = np.stack([np.cos(a) * x - np.sin(a) * z, y, np.sin(a) * x + np.cos(a) * z], axis=1)
        terms.append((np.linalg.norm(local / half, axis=1) - 1) * min(half))
    return -BLEND * np.log(np.exp(-np.array(terms) / BLEND).sum(axis=0))


def surface(parts):
    """Return the closed mesh of the level set."""
    low, high = np.array([-1.8, -1.2, -0.5]), np.array([1.9, 1.2, 2.7])
    count = np.ceil((high - low) / SPACING).astype(int)
    grid = low + SPACING * np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), axis=-1)
    values = level(grid.reshape(-1, 3), parts).reshape(count)
    vertices, faces, _, _ = marching_cubes(values, 0.0, spacing=(SPACING,) * 3, gradient_direction="ascent")
    mesh = trimesh.Trimesh((vertices + low).round(4), faces)
    mesh.merge_vertices()
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.fix_normals()
    if not mesh.is_watertight or mesh.body_count != 1:
        raise SystemExit("the surface is not one closed body")
    return mesh


if __name__ == "__main__":
    for name, parts in (("rabbit", RABBIT), ("duck", DUCK)):
        mesh = surface(parts)
        mesh.export(pathlib.Path(__file__).with_name(f"{name}.ply"), vertex_normal=False)
        print(f"{name}: {len(mesh.vertices)} vertices, volume {mesh.volume:.3f}, extents {mesh.extents}")
