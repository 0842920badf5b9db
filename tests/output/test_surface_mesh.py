"""V19: surfaces are watertight, spheres have Euler number 2, volumes are right; files are read by others."""

import shutil
import subprocess

import numpy as np
import pytest
import trimesh
from PIL import Image
from run_samples import drop_and_cube

from melt import params
from melt.output import mesh_files
from melt.output.errors import OutputError
from melt.output.picture import render
from melt.output.surface_mesh import _Cells, components, join, reconstruct, spacing_of

DX = 0.01


def ball(radius, centre=(5.0, -3.0, 2.0), jitter=0.0, seed=0):
    """Lattice particles (n, 3) in a sphere; radius in spacings."""
    axis = np.arange(-int(radius) - 1, int(radius) + 1) + 0.5
    x = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    x = x[(x**2).sum(axis=1) < radius**2]
    x = x + np.random.default_rng(seed).uniform(-jitter, jitter, x.shape)
    return x * DX + centre


def edge_counts(mesh):
    edges = np.sort(np.concatenate([mesh.faces[:, p] for p in ([0, 1], [1, 2], [2, 0])]), axis=1)
    return np.unique(edges, axis=0, return_counts=True)[1]


def euler(mesh):
    return len(mesh.vertices) - len(edge_counts(mesh)) + len(mesh.faces)


@pytest.mark.parametrize("correct", [False, True])
@pytest.mark.parametrize("jitter", [0.0, 0.2])
def test_sphere_of_ten_spacings(correct, jitter):
    x = ball(10, jitter=jitter)
    mesh = reconstruct(x, x[:, 0], spacing=DX, correct=correct)
    assert set(edge_counts(mesh)) == {2} and euler(mesh) == 2
    assert mesh.volume() == pytest.approx(4 / 3 * np.pi * (10 * DX) ** 3, rel=0.05)
    outward = (mesh.vertices - (5, -3, 2)) * mesh.normals
    assert outward.sum(axis=1).min() > 0.8 * 10 * DX
    # a temperature that is linear in x stays linear, up to the one-sided mean at the surface
    assert np.abs(mesh.temperature - mesh.vertices[:, 0]).max() < 0.7 * DX


@pytest.mark.parametrize("seed", range(3))
def test_splashes_are_watertight(seed):
    x = np.random.default_rng(seed).uniform(0, 0.15, (1500, 3))
    mesh = reconstruct(x, spacing=DX)
    assert set(edge_counts(mesh)) == {2} and mesh.volume() > 0


@pytest.mark.parametrize("gap, node", [(2.8, 0.5), (2.4, 0.25), (2.6, 0.25)])
def test_correction_removes_the_sheet_between_two_drops(gap, node):
    """The plain field puts a third body into the gap between two balls, the corrected one does not."""
    pair = np.concatenate([ball(6, (0, 0, 0)), ball(6, ((11 + gap) * DX, 0, 0))])

    def bodies(correct):
        mesh = reconstruct(pair, spacing=DX, correct=correct, node=node)
        return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).body_count

    assert (bodies(False), bodies(True)) == (3, 2)


def test_components_are_meshed_apart():
    """Two bodies, one of a single particle, and their volumes."""
    x = np.concatenate([ball(5, (0, 0, 0)), [[9 * DX, 0, 0]]])
    meshes = components(x, spacing=DX, node=0.1)
    assert [euler(m) for m in meshes] == [2, 2]
    assert meshes[1].volume() == pytest.approx(4 / 3 * np.pi * (0.6 * DX) ** 3, rel=0.03)
    both = join(meshes)
    assert both.volume() == pytest.approx(sum(m.volume() for m in meshes)) and euler(both) == 4


def test_no_particle_and_one_particle():
    assert len(reconstruct(np.zeros((0, 3)), spacing=DX).faces) == 0 and components(np.zeros((0, 3))) == []
    assert len(join([]).faces) == 0
    one = reconstruct(np.ones((1, 3)), np.array([7.0]), spacing=DX)
    assert euler(one) == 2 and np.allclose(one.temperature, 7.0)
    assert spacing_of(ball(4)) == pytest.approx(DX)


def test_band_leaves_out_nothing_that_matters():
    """The field deep inside is not computed: a ball's mesh is the same as from all nodes."""
    x = ball(9, (0, 0, 0), jitter=0.2)
    tuple_ = params.make(
        params.Reconstruction, np.float32, reach=2 * DX, radius=0.6 * DX, correct=1, temperature=0
    )
    cells = _Cells(x, None, 2 * DX, 4)
    band = cells.field(tuple_, DX, "cpu")
    everything = cells.field(tuple_, DX / 100, "cpu")  # no cell is full then
    skipped = band != everything
    assert skipped.sum() > 500 and (everything[skipped] < -0.2 * DX).all() and (band[skipped] < 0).all()


def test_backends_give_the_same_mesh():
    fast, slow = (reconstruct(ball(4), spacing=DX, backend=name) for name in ("cpu", "reference"))
    assert np.array_equal(fast.faces, slow.faces)
    assert np.abs(fast.vertices - slow.vertices).max() < 1e-4 * DX


def test_a_far_splash_does_not_blow_up_memory():
    x = np.concatenate([ball(8), [[5000.0, 5000.0, 5000.0]]])
    mesh = reconstruct(x, spacing=DX)
    assert euler(mesh) == 2


# --- files ---


@pytest.mark.parametrize("suffix", [".ply", ".obj"])
def test_files_that_trimesh_reads(tmp_path, suffix):
    run = drop_and_cube(tmp_path / "a.vtkhdf")
    render(run, tmp_path / f"a{suffix}", frame=0)
    mesh = trimesh.load(tmp_path / f"a{suffix}", process=False)
    assert mesh.is_watertight and mesh.euler_number == 4
    both = (4 / 3 * np.pi * 6**3 + 6**3) * 0.02**3
    assert mesh.volume == pytest.approx(both, rel=0.12)
    rgb = mesh.visual.vertex_colors[:, :3].astype(int)
    cold, hot = mesh.vertices[:, 0] > 0.3, mesh.vertices[:, 0] < 0.1
    assert (rgb[cold, 2] > rgb[cold, 0]).all() and (rgb[hot, 0] > rgb[hot, 2]).all()


def test_vtp_is_read_by_vtk(tmp_path):
    vtk = pytest.importorskip("vtk")
    run = drop_and_cube(tmp_path / "a.vtkhdf")
    render(run, tmp_path / "a.vtp", frame=0, phase="solid")
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "a.vtp"))
    reader.Update()
    data = reader.GetOutput()
    assert data.GetNumberOfPolys() > 100 and data.GetPointData().GetArray("temperature").GetRange()[1] < 0
    mass = vtk.vtkMassProperties()
    mass.SetInputData(data)
    assert mass.GetVolume() == pytest.approx(6**3 * 0.02**3, rel=0.15)


def test_pov_ray_renders_the_scene(tmp_path):
    run = drop_and_cube(tmp_path / "a.vtkhdf")
    render(run, tmp_path / "a.pov", frame=0)
    text = (tmp_path / "a.pov").read_text()
    assert text.count("mesh2 {") == 2 and "ior 1.33" in text and "ior 1.31" in text
    assert all(word in text for word in ("vertex_vectors", "normal_vectors", "face_indices"))
    if not shutil.which("povray"):
        pytest.skip("povray is not installed")
    command = ["povray", "+Ia.pov", "+Oa.png", "+W128", "+H72", "-D", "-A", "+WT1"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-1500:]
    picture = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).astype(int)
    # the hot drop is at the left, the ice at the right: a mirrored scene would show the opposite
    red, blue = picture[..., 0] - picture[..., 2], picture[..., 2] - picture[..., 0]
    x = np.arange(128)
    assert (x * (red > 40).sum(axis=0)).sum() / (red > 40).sum() < 64
    assert (x * (blue > 40).sum(axis=0)).sum() / (blue > 40).sum() > 64


def test_handedness_keeps_normals_outward():
    mesh = reconstruct(ball(4, (0, 0, 0)), spacing=DX)
    swapped = mesh_files._left(mesh.vertices)
    a, b, c = (swapped[mesh.faces[:, ::-1][:, k]] for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0  # right-handed formula: winding was turned back


def test_unknown_suffix_and_phase(tmp_path):
    run = drop_and_cube(tmp_path / "a.vtkhdf")
    with pytest.raises(OutputError, match=r"\.png, \.mp4, \.ply"):
        render(run, tmp_path / "a.gif")
    with pytest.raises(OutputError, match="unknown phase"):
        render(run, tmp_path / "a.ply", phase="gas")
    with pytest.raises(OutputError, match="folder does not exist"):
        render(run, tmp_path / "no" / "a.ply")
