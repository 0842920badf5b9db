"""Meshes: containment against closed forms and trimesh, wanted counts, refusals, repair."""

import numpy as np
import pytest
import trimesh

from melt.errors import GeometryError
from melt.geometry import mesh
from melt.geometry.build import build
from melt.scene import load_scene


def arrays(m):
    return np.asarray(m.vertices, float), np.asarray(m.faces)


def test_voxels_of_a_box_are_the_lattice_points_inside():
    vertices, faces = arrays(trimesh.creation.box((4, 6, 8)))
    assert mesh.voxelise(vertices, faces).shape == (3, 4 * 6 * 8)
    assert mesh.voxelise(vertices + 0.3, faces).shape == (3, 4 * 6 * 8)
    assert mesh.voxelise(vertices * 0.1, faces).shape[1] == 0


def test_voxels_of_a_sphere_are_the_points_within_its_radius():
    vertices, faces = arrays(trimesh.creation.icosphere(subdivisions=5, radius=9.7))
    cells = mesh.voxelise(vertices + [0.31, -7.2, 100.4], faces)
    grid = np.stack(
        np.meshgrid(*[np.arange(a, b) for a, b in ((-12, 12), (-20, 5), (88, 113))], indexing="ij")
    )
    r = np.linalg.norm(grid.reshape(3, -1).T + 0.5 - [0.31, -7.2, 100.4], axis=1)
    inner, outer = (r < 9.68).sum(), (r < 9.7).sum()  # the mesh is inscribed
    assert inner <= cells.shape[1] <= outer


def test_overlapping_closed_parts_count_once():
    two = trimesh.util.concatenate(
        [trimesh.creation.box((4, 4, 4)), trimesh.creation.box((4, 4, 4)).apply_translation([2, 0, 0])]
    )
    assert mesh.voxelise(*arrays(two)).shape[1] == 6 * 4 * 4


def test_inside_out_mesh_is_sampled_the_same():
    box = trimesh.creation.box((4, 4, 4))
    box.invert()
    assert mesh.voxelise(*arrays(box)).shape[1] == 64


@pytest.mark.parametrize("name", ["duck", "rabbit"])
@pytest.mark.parametrize("wanted", [200, 5000])
def test_scale_is_bisected_to_the_wanted_count(name, wanted):
    vertices, faces = mesh.read_mesh(name)
    cells, scale = mesh.voxelise_to_count(vertices, faces, lambda x: x + [0.2, 0.7, 3.1], wanted)
    assert abs(cells.shape[1] - wanted) <= 0.02 * wanted
    volume = trimesh.load(mesh.find_mesh(name)).volume * scale**3
    assert cells.shape[1] == pytest.approx(volume, rel=0.02 if wanted == 5000 else 0.1)


def test_rotation_turns_about_x_then_y_then_z():
    assert mesh.rotation_matrix([0, 0, 90]) @ [1, 0, 0] == pytest.approx([0, 1, 0])
    assert mesh.rotation_matrix([90, 0, 90]) @ [0, 1, 0] == pytest.approx([0, 0, 1])
    assert mesh.rotation_matrix([0, 90, 0]) @ [0, 0, 1] == pytest.approx([1, 0, 0])


def test_open_mesh_is_refused_and_can_be_repaired(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=3, radius=5.0)
    rest = 4 / 3 * np.pi * 125 - np.pi / 3 * 14  # without a cap of height 1
    ball.update_faces(ball.triangles_center[:, 2] < 4.2)
    path = tmp_path / "open.ply"
    ball.export(path)
    with pytest.raises(GeometryError, match="not watertight.*repair = true"):
        mesh.read_mesh(str(path))
    count = mesh.voxelise(*mesh.read_mesh(str(path), repair=True)).shape[1]
    assert count == pytest.approx(rest, rel=0.04)


def test_file_that_is_no_mesh_is_refused(tmp_path):
    path = tmp_path / "text.ply"
    path.write_text("not a mesh")
    with pytest.raises(GeometryError, match="cannot be read"):
        mesh.read_mesh(str(path))
    points = tmp_path / "points.ply"
    trimesh.PointCloud(np.eye(3)).export(points)
    with pytest.raises(GeometryError, match="no triangles"):
        mesh.read_mesh(str(points))


def test_mesh_beside_the_scene_file_is_found(tmp_path, monkeypatch):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "block.stl")
    (tmp_path / "mine.toml").write_text(
        "[time]\nend = 1\n[domain]\nupper = [2, 2, 2]\n"
        '[[solid]]\nshape = "mesh"\nfile = "block.stl"\nposition = [1, 1, 0.4]\nanchor = "base"\n'
    )
    monkeypatch.chdir("/")
    assert build(load_scene(tmp_path / "mine.toml")).counts["solid"] == 125
