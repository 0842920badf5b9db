"""Rasters and terrain surfaces: they come back as they were written, whole or not at all."""

import errno
import os
import pathlib
import sys

import h5py
import numpy as np
import pytest

from melt.geometry.terrain import load_terrain
from melt.output.errors import OutputError
from melt.output.rasters import raster_suffix, write_raster
from melt.output.terrain_file import write_terrain
from melt.scene.terrain import Terrain

PLACE = (2.0, 0.0, 382000.0, 0.0, -2.0, 6354012.0)


def source(folder, place=PLACE, crs="EPSG:32756"):
    """Write a DEM of 6 x 8 nodes, row 0 north, with a hole; return its path and values."""
    rasterio = pytest.importorskip("rasterio")
    z = np.arange(48, dtype=np.float32).reshape(6, 8) + 20
    z[2, 3] = -9999
    path = folder / "in.tif"
    with rasterio.open(
        path, "w", driver="GTiff", width=8, height=6, count=1, dtype="float32", crs=crs, nodata=-9999,
        transform=rasterio.Affine(*place),
    ) as file:  # fmt: skip
        file.write(z, 1)
    return path, z


@pytest.fixture
def grid(tmp_path):
    return load_terrain(Terrain(file=str(source(tmp_path)[0])))


def depths(grid):
    values = (grid.elevation + grid.datum).astype(np.float32)
    values[grid.blocked] = np.nan
    return values


@pytest.mark.parametrize("place", [PLACE, (1.0, 0.0, 382000.25, 0.0, -3.0, 6354012.5)])
@pytest.mark.parametrize("suffix", [".tif", ".asc"])
def test_a_raster_has_the_georeference_and_values_of_its_terrain(suffix, place, tmp_path):
    rasterio = pytest.importorskip("rasterio")
    path, z = source(tmp_path, place)
    grid = load_terrain(Terrain(file=str(path)))
    out = tmp_path / f"depth{suffix}"
    write_raster(out, depths(grid), grid, unit="m")
    with rasterio.open(path) as a, rasterio.open(out) as b:
        assert b.transform == a.transform
        assert b.crs.to_epsg() == 32756 or b.crs.to_dict() == a.crs.to_dict()
        assert b.nodata == -9999 and (b.read(1) == z).all()
        if suffix == ".tif":
            assert b.profile["compress"] == "lzw" and b.profile["tiled"] and b.dtypes == ("float32",)
            assert b.crs == a.crs and b.units == ("m",)
    again = load_terrain(Terrain(file=str(out)))
    assert (again.elevation == grid.elevation).all() and (again.blocked == grid.blocked).all()
    assert again.origin == grid.origin and again.lower == grid.lower and again.transform == grid.transform
    assert sorted(os.listdir(tmp_path)) == sorted(["in.tif", out.name] + ["depth.prj"] * (suffix == ".asc"))


def test_a_raster_of_a_clip_lies_where_the_clip_is(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    path, z = source(tmp_path)
    part = load_terrain(Terrain(file=str(path), lower=[382004, 6354002], upper=[382012, 6354010]))
    write_raster(tmp_path / "a.tif", depths(part), part)
    with rasterio.open(path) as a, rasterio.open(tmp_path / "a.tif") as b:
        x, y = b.xy(0, 0)
        assert (x, y) == (382005, 6354009)
        assert a.read(1)[a.index(x, y)] == b.read(1)[0, 0]


def test_degrees_come_back(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    grid = load_terrain(Terrain(source="jacksboro"))
    write_raster(tmp_path / "a.tif", grid.elevation + grid.datum, grid)
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.crs.to_epsg() == 4326 and file.read(1)[0, 0] == 483
        assert file.bounds == pytest.approx((-84.41375, 36.44625, -84.077917, 36.732917))


def test_without_rasterio_there_is_ascii(tmp_path, monkeypatch):
    grid = load_terrain(Terrain(source="jacksboro"))
    for name in [n for n in sys.modules if n.startswith("rasterio")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rasterio", None)
    assert raster_suffix() == ".asc"
    with pytest.raises(OutputError, match=r"pip install 'melt\[terrain\]', or name a file .asc"):
        write_raster(tmp_path / "a.tif", grid.elevation, grid)
    assert os.listdir(tmp_path) == []
    write_raster(tmp_path / "a.asc", grid.elevation, grid)
    assert (tmp_path / "a.asc").read_text().startswith("ncols 403\nnrows 344\nxllcorner -84.41375\n")
    assert "4326" in (tmp_path / "a.prj").read_text()


def test_values_that_do_not_fit(grid, tmp_path):
    for path, values, said in (
        ("a.png", grid.elevation, "one of .tif, .tiff, .asc"),
        ("a.tif", grid.elevation[1:], "the values are (5, 8), the terrain has (6, 8) nodes"),
        ("a.tif", np.full(grid.shape, -9999.0), "48 values equal the nodata value -9999"),
    ):
        with pytest.raises(OutputError) as caught:
            write_raster(tmp_path / path, values, grid)
        assert said in str(caught.value)
    assert os.listdir(tmp_path) == ["in.tif"]
    write_raster(tmp_path / "a.asc", np.full(grid.shape, np.inf), grid, nodata=-1)
    assert "-1 -1" in (tmp_path / "a.asc").read_text()


@pytest.mark.parametrize("suffix", [".tif", ".asc", ".vtkhdf"])
@pytest.mark.parametrize(("code", "said"), [(errno.ENOSPC, "the disk is full"), (errno.EACCES, "no permission")])
def test_a_failed_write_leaves_the_old_file_and_nothing_else(suffix, code, said, grid, tmp_path, monkeypatch):
    path = tmp_path / f"a{suffix}"
    path.write_text("old")

    def fail(*_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OutputError, match=said):
        write_terrain(path, grid) if suffix == ".vtkhdf" else write_raster(path, grid.elevation, grid)
    assert path.read_text() == "old"
    assert sorted(os.listdir(tmp_path)) == sorted([path.name, "in.tif"])


def test_places_that_take_no_file(grid, tmp_path):
    with pytest.raises(OutputError, match="the folder does not exist"):
        write_raster(tmp_path / "none" / "a.tif", grid.elevation, grid)
    (tmp_path / "b.tif").mkdir()
    with pytest.raises(OutputError, match="this is a folder"):
        write_raster(tmp_path / "b.tif", grid.elevation, grid)


def surface(path):
    """Return (points, cells (k, 4), elevation, origin) that VTK's own reader finds."""
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    errors = []
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(pathlib.Path(path)))
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("reader"))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: errors.append("pipeline"))
    reader.Update()
    assert not errors
    data = reader.GetOutput()
    assert data.GetNumberOfPolys() == data.GetNumberOfCells()
    cells = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 4)
    return (
        vtk_to_numpy(data.GetPoints().GetData()), cells,
        vtk_to_numpy(data.GetPointData().GetArray("elevation")),
        vtk_to_numpy(data.GetFieldData().GetArray("origin")).ravel(),
    )  # fmt: skip


def test_vtk_opens_the_surface(grid, tmp_path):
    assert write_terrain(tmp_path / "a.vtkhdf", grid) == 1
    points, cells, elevation, origin = surface(tmp_path / "a.vtkhdf")
    assert points.dtype == np.float32 and points.shape == (48, 3)
    assert (points[:, 2].reshape(6, 8) == grid.elevation).all()
    assert points[9].tolist() == [grid.x[1], grid.y[1], grid.elevation[1, 1]]
    assert elevation == pytest.approx(points[:, 2] + grid.datum)
    assert origin.tolist() == [382000, 6354000, grid.datum]
    assert len(cells) == 5 * 7 - 4  # those round the hole are left out
    a, b, c = (points[cells[:, k]] for k in range(3))
    assert (np.cross(b - a, c - b)[:, 2] > 0).all()  # they face up
    with h5py.File(tmp_path / "a.vtkhdf") as file:
        assert file["VTKHDF"].attrs["Version"].tolist() == [2, 3]
        assert "56S" in file["melt"].attrs["crs"]


def test_a_large_terrain_is_thinned(grid, tmp_path):
    assert write_terrain(tmp_path / "a.vtkhdf", grid, most=12, scale=10.0) == 2
    points, cells, elevation, _ = surface(tmp_path / "a.vtkhdf")
    assert (points[:, 2] == 10 * grid.elevation[::2, ::2].ravel()).all() and len(points) == 12
    assert elevation == pytest.approx(grid.datum + grid.elevation[::2, ::2].ravel())
    assert len(cells) <= 6


def test_a_surface_without_cells_opens(tmp_path):
    path, _ = source(tmp_path)
    ring = [[381990, 6353990], [382100, 6353990], [382100, 6354009], [381990, 6354009]]
    grid = load_terrain(Terrain(file=str(path), raised=[{"polygon": ring, "wall": True}]))
    write_terrain(tmp_path / "a.vtkhdf", grid, most=8)
    assert surface(tmp_path / "a.vtkhdf")[1].shape == (0, 4)
