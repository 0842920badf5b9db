"""Terrain from files: registration, local frame, units, nodata policies, clips, buildings, roughness."""

import h5py
import numpy as np
import pytest
from terrain_files import UTM56, hide_rasterio, hill, hill_tif, terrain, write_tif

from melt.geometry import terrain_nodata
from melt.geometry.terrain import FAR
from melt.geometry.terrain_zones import manning_grid
from melt.scene.terrain import Friction

ASC = "ncols 4\nnrows 3\n{x} 100\n{y} 200\ncellsize 10\nNODATA_value -9999\n1 2 3 4\n5 6 7 8\n9 10 11 12\n"


def bed(grid):
    return grid.elevation + grid.datum


# --- registration and the local frame ---------------------------------------------------------


def test_a_geotiff_is_registered_at_cell_centres_and_its_row_0_is_north(tmp_path):
    z, x, y = hill(south_west=(382000, 6354000))
    grid = terrain(file=hill_tif(tmp_path / "a.tif"))
    assert grid.shape == (6, 8) and grid.cell == (2.0, 2.0)
    assert grid.origin == (382000.0, 6354000.0)
    assert grid.lower == (1.0, 1.0)
    assert bed(grid) == pytest.approx(z, abs=1e-6)
    assert grid.elevation.min() == 0 and grid.elevation.dtype == np.float64
    assert grid.world([grid.x[3], grid.y[2]]) == pytest.approx([x[3], y[2]], abs=1e-9)
    assert grid.bounds.tolist() == [[0, 0], [16, 12]]
    assert grid.transform == (2.0, 0.0, 382000.0, 0.0, -2.0, 6354012.0)
    assert "UTM zone 56S" in grid.crs
    assert not grid.blocked.any() and not grid.open.any() and (grid.wall_distance == FAR).all()


def test_utm_northings_keep_local_precision():
    """A float32 at 6.35e6 m has steps of 0.5 m; local coordinates keep what float64 world coordinates say."""
    from melt.geometry.terrain import TerrainGrid

    none = np.zeros((3, 3), bool)
    grid = TerrainGrid(
        np.zeros((3, 3)), none, none, (0.5, 0.5), (1.0, 1.0), (382249.0, 6354265.0), 0.0, (1, 0, 0, 0, -1, 0)
    )
    world = np.array([[382250.123, 382260.456], [6354280.001, 6354281.377]])
    local = grid.local(world)
    assert np.abs(grid.world(local) - world).max() < 2e-9
    assert np.abs(local.astype(np.float32) - local).max() < 1e-6
    assert np.abs(world[1].astype(np.float32) - world[1]).max() > 0.1
    assert grid.node([2.4, 1.6]) == (1, 2)


def test_the_same_ground_is_the_same_locally_wherever_it_lies(tmp_path):
    near = terrain(file=hill_tif(tmp_path / "a.tif", (0.0, 0.0)))
    far = terrain(file=hill_tif(tmp_path / "b.tif", (382000.0, 6354000.0)))
    assert near.origin == (0.0, 0.0)
    assert (near.elevation == far.elevation).all()
    assert near.lower == far.lower and near.cell == far.cell and near.datum == far.datum


@pytest.mark.parametrize(("key", "start"), [("corner", 105.0), ("center", 100.0)])
def test_ascii_says_corner_or_centre(key, start, tmp_path):
    (tmp_path / "a.asc").write_text(ASC.format(x=f"xll{key}", y=f"YLL{key.upper()}"))
    grid = terrain(tmp_path, file="a.asc")
    assert bed(grid)[:, 0].tolist() == [9, 5, 1]
    assert grid.world(grid.lower) == pytest.approx([start, start + 100])
    assert grid.cell == (10.0, 10.0)


def test_ascii_reads_as_gdal_reads_it(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    (tmp_path / "a.asc").write_text(ASC.format(x="xllcenter", y="yllcenter").replace("7", "-9999"))
    grid = terrain(tmp_path, file="a.asc")
    with rasterio.open(tmp_path / "a.asc") as file:
        assert tuple(file.transform)[:6] == grid.transform
        assert (file.read_masks(1)[::-1] == 0).tolist() == grid.blocked.tolist()


@pytest.mark.parametrize("name", ["z", "elevation"])
@pytest.mark.parametrize("kind", ["npz", "h5"])
@pytest.mark.parametrize("down", [False, True])
def test_numpy_and_hdf5_say_centres_in_either_order(name, kind, down, tmp_path):
    z, x, y = hill(cell=(2.0, 3.0))
    parts = {"x": x, "y": y[::-1] if down else y, name: (z[::-1] if down else z).astype(np.float32)}
    path = tmp_path / f"a.{kind}"
    if kind == "npz":
        np.savez(path, crs=UTM56, **parts)
    else:
        with h5py.File(path, "w") as file:
            file.attrs["crs"] = UTM56
            for key, value in parts.items():
                file[key] = value
    grid = terrain(file=str(path))
    assert bed(grid) == pytest.approx(z, abs=1e-6)
    assert grid.cell == (2.0, 3.0) and grid.lower == (1.0, 1.5) and grid.crs == UTM56


def test_npy_takes_the_cell_from_the_scene(tmp_path):
    z = hill()[0]
    np.save(tmp_path / "a.npy", z)
    grid = terrain(file=str(tmp_path / "a.npy"), cell=[2.0, 4.0])
    assert bed(grid) == pytest.approx(z) and grid.cell == (2.0, 4.0) and grid.lower == (1.0, 2.0)


def test_a_terrain_at_hand_loads_without_rasterio(monkeypatch):
    hide_rasterio(monkeypatch)
    grid = terrain(source="jacksboro")
    assert grid.shape == (344, 403)
    assert grid.cell == pytest.approx((74.4, 92.6), rel=5e-3)
    assert grid.datum == 236 and grid.elevation.max() == 1076 - 236
    assert bed(grid)[-1, 0] == 483  # north-west corner
    assert "4326" in grid.crs and grid.transform[0] == pytest.approx(1 / 1200)
    assert any("degrees" in note for note in grid.notes)


def test_degrees_are_reprojected_when_asked():
    pytest.importorskip("rasterio")
    flat, warped = terrain(source="jacksboro"), terrain(source="jacksboro", reproject="utm")
    assert "zone 16N" in warped.crs
    assert warped.blocked.any() and warped.origin[1] > 4e6  # the corners of a turned square hold nothing
    assert np.median(bed(warped)[~warped.blocked]) == pytest.approx(np.median(bed(flat)), rel=0.01)
    area = [np.prod(g.cell) * (~g.blocked).sum() for g in (flat, warped)]
    assert area[1] == pytest.approx(area[0], rel=0.01)


# --- values -----------------------------------------------------------------------------------


def test_constant_and_anisotropic_terrain(tmp_path):
    grid = terrain(file=hill_tif(tmp_path / "a.tif", cell=(1.0, 5.0), z=np.full((5, 4), 7.0)))
    assert grid.cell == (1.0, 5.0) and grid.datum == 7 and (grid.elevation == 0).all()


def test_scale_offset_and_feet(tmp_path):
    z = np.arange(12.0).reshape(3, 4)
    path = hill_tif(tmp_path / "a.tif", z=z, scales=(0.01,), offsets=(5.0,), units=("ft",), dtype="int16")
    assert bed(terrain(file=path)) == pytest.approx(0.3048 * (0.01 * z + 5))
    override = terrain(file=path, scale=2.0, offset=0.0, vertical_unit="us-ft")
    assert bed(override) == pytest.approx(1200 / 3937 * 2 * z)
    assert any("us-ft" in note for note in override.notes)


def test_a_reference_system_in_feet_is_metres_inside(tmp_path):
    path = write_tif(tmp_path / "a.tif", np.ones((4, 5), np.float32), (10.0, 0, 2e6, 0, -10.0, 5e5), "EPSG:2264")
    grid = terrain(file=path)
    assert grid.cell == pytest.approx((10 * 1200 / 3937,) * 2)
    assert grid.world(grid.lower) == pytest.approx([2000005, 500000 - 35])
    assert grid.local(grid.world([3.0, 4.0])) == pytest.approx([3, 4], abs=1e-8)
    assert grid.transform[0] == 10.0


def test_a_clip_keeps_the_nodes_inside(tmp_path):
    path = hill_tif(tmp_path / "a.tif")
    whole, part = terrain(file=path), terrain(file=path, lower=[382004, 6354002], upper=[382012, 6354010])
    assert part.shape == (4, 4)
    assert (bed(part) == bed(whole)[1:5, 2:6]).all()
    assert part.world(part.lower).tolist() == [382005, 6354003]
    assert part.transform == (2.0, 0.0, 382004.0, 0.0, -2.0, 6354010.0)
    one_sided = terrain(file=path, upper=[382012, 6354010])
    assert one_sided.shape == (5, 6)


def test_a_clip_of_a_file_without_windows_is_the_same(tmp_path):
    z, x, y = hill(south_west=(382000, 6354000))
    np.savez(tmp_path / "a.npz", x=x, y=y, z=z)
    keys = dict(lower=[382004, 6354002], upper=[382012, 6354010])
    a, b = terrain(file=hill_tif(tmp_path / "a.tif"), **keys), terrain(file=str(tmp_path / "a.npz"), **keys)
    assert a.elevation == pytest.approx(b.elevation, abs=1e-6)
    assert a.lower == b.lower and a.transform == pytest.approx(b.transform) and a.origin == b.origin


def test_a_rotated_raster_is_resampled_when_asked(tmp_path):
    """The plane of the rotated raster is the same function of x and y afterwards."""
    turn = np.radians(30.0)
    a, b, d, e = 2 * np.cos(turn), 2 * np.sin(turn), 2 * np.sin(turn), -2 * np.cos(turn)
    column, row = np.meshgrid(np.arange(40) + 0.5, np.arange(30) + 0.5)
    x, y = a * column + b * row + 1000, d * column + e * row + 2000
    path = write_tif(tmp_path / "a.tif", 0.1 * x - 0.3 * y + 900, (a, b, 1000.0, d, e, 2000.0))
    grid = terrain(file=path, resample=True)
    assert grid.cell == pytest.approx((2, 2)) and 0.2 < grid.blocked.mean() < 0.6
    x, y = grid.world(np.stack(np.meshgrid(grid.x, grid.y)))
    # within half a cell of its rim the raster says the same as at the rim
    error = np.abs(bed(grid) - (0.1 * x - 0.3 * y + 900))[grid.wall_distance > 3]
    assert error.max() < 1e-6
    assert any("30 degrees" in note for note in grid.notes)


def test_resampling_to_a_cell_keeps_a_plane_and_the_mean(tmp_path):
    path = hill_tif(tmp_path / "a.tif", z=hill(40, 60)[0])
    for cell in (1.0, 4.0):
        grid = terrain(file=path, resample=cell)
        assert grid.cell == (cell, cell) and grid.shape == (80 / cell, 120 / cell)
        x, y = np.meshgrid(grid.x, grid.y)
        inner = (slice(3, -3),) * 2
        assert np.abs(bed(grid) - (10 + 0.1 * x + 0.2 * y))[inner].max() < 1e-5
        assert grid.transform[0] == cell


# --- nodata -----------------------------------------------------------------------------------


def holed(path, value=np.nan, **options):
    z = hill(12, 14)[0]
    z[4:7, 5:9] = value
    return hill_tif(path, z=z, **options)


def test_nodata_is_a_wall(tmp_path):
    grid = terrain(file=holed(tmp_path / "a.tif", -9999, nodata=-9999))
    assert grid.blocked.sum() == 12 and grid.blocked[4:7, 5:9].all() and not grid.open.any()
    assert np.isfinite(grid.elevation).all() and grid.elevation.min() == 0 and grid.elevation.max() < 7.01
    assert any("12 of 168 nodes" in note and "walls" in note for note in grid.notes)
    distance = grid.wall_distance
    assert distance.dtype == np.float32
    assert distance[5, 4] == 1 and distance[5, 5] == -1  # the edge of the cell is half way
    assert distance[5, 2] == 5 and distance[3, 4] == pytest.approx(np.sqrt(2))
    assert (distance[grid.blocked] < 0).all() and (distance[~grid.blocked] > 0).all()


def test_nodata_is_open(tmp_path):
    grid = terrain(file=holed(tmp_path / "a.tif"), nodata="open")
    assert grid.open.sum() == 12 and not grid.blocked.any() and np.isfinite(grid.elevation).all()


def test_nodata_is_filled_with_the_plane_around_it(tmp_path):
    grid = terrain(file=holed(tmp_path / "a.tif", np.inf), nodata="fill")
    assert not grid.blocked.any() and not grid.open.any()
    assert bed(grid) == pytest.approx(hill(12, 14)[0], abs=1e-3)  # harmonic: a plane is its own fill
    assert any("12 of 168 nodes" in note and "filled" in note for note in grid.notes)


def test_a_large_gap_takes_the_nearest_elevation(tmp_path, monkeypatch):
    monkeypatch.setattr(terrain_nodata, "MOST_HARMONIC", 11)
    grid = terrain(file=holed(tmp_path / "a.tif"), nodata="fill")
    assert bed(grid)[5, 5] == bed(grid)[5, 4] and bed(grid)[4, 6] == bed(grid)[3, 6]
    assert any("filled from the nearest one" in note for note in grid.notes)


def test_distances_know_cells_that_are_not_square(tmp_path):
    z = np.zeros((9, 9))
    z[4, 4] = np.nan
    distance = terrain(file=hill_tif(tmp_path / "a.tif", cell=(1.0, 3.0), z=z)).wall_distance
    assert distance[4, 2] == 1.5 and distance[6, 4] == 4.5 and distance[4, 4] == -0.5


def test_nodata_value_of_the_scene(tmp_path):
    grid = terrain(file=holed(tmp_path / "a.tif", 1e38), nodata_value=1e38)
    assert grid.blocked.sum() == 12
    unused = terrain(file=hill_tif(tmp_path / "b.tif"), nodata_value=-5)
    assert any("occurs nowhere" in note for note in unused.notes)


def test_deep_sea_is_no_nodata(tmp_path):
    z = np.linspace(-10900, -200, 48).reshape(6, 8)
    z[0, 5] = -9999
    assert not terrain(file=hill_tif(tmp_path / "a.tif", z=z)).blocked.any()


# --- buildings, levees, roughness -------------------------------------------------------------


def test_buildings_are_raised(tmp_path):
    path = hill_tif(tmp_path / "a.tif", z=np.zeros((10, 12)), south_west=(382000.0, 6354000.0))
    (tmp_path / "b.csv").write_text(
        "house_id,vertex,x,y\n7,0,382003,6354003\n7,1,382009,6354003\n7,2,382009,6354009\n7,3,382003,6354009\n"
        "8,0,1,1\n8,1,2,1\n8,2,2,2\n"
    )
    grid = terrain(tmp_path, file=path, raised=[{"file": "b.csv", "height": 3.0}])
    raised = np.zeros((10, 12))
    raised[1:5, 1:5] = 3.0  # centres at 3, 5, 7, 9: the edge counts as inside
    assert (grid.elevation == raised).all()
    assert any("16 nodes of 2 polygons raised by 3 m" in note for note in grid.notes)
    assert any("1 of 2 polygons hold no node" in note for note in grid.notes)
    square = [[382003, 6354003], [382009, 6354003], [382009, 6354009], [382003, 6354009]]
    walled = terrain(file=path, raised=[{"polygon": square, "wall": True}])
    assert (walled.blocked == (raised > 0)).all() and (walled.elevation == 0).all()


def test_a_levee_has_a_level_crest(tmp_path):
    line = [[2.0, 10.0], [14.0, 10.0], [14.0, 20.0]]
    grid = terrain(
        shape="plane", parameters={"slope": 0.1}, cell=1.0, lower=[0, 0], upper=[30, 30],
        raised=[{"line": line, "width": 3.0, "crest": 2.0}],
    )  # fmt: skip
    x, y = np.meshgrid(grid.x, grid.y)
    near = np.minimum(
        np.hypot(x - np.clip(x, 2, 14), y - 10), np.hypot(x - 14, y - np.clip(y, 10, 20))
    )
    core = (near < 1.4) & (x > 2) & (y < 20)
    assert bed(grid)[core] == pytest.approx(2.0)
    assert bed(grid)[near > 1.6] == pytest.approx((-0.1 * x)[near > 1.6])


def test_overlapping_polygons_of_one_entry_are_not_stacked(tmp_path):
    (tmp_path / "b.csv").write_text(
        "house_id,vertex,x,y\n0,0,1,1\n0,1,6,1\n0,2,6,6\n0,3,1,6\n1,0,3,3\n1,1,9,3\n1,2,9,9\n1,3,3,9\n"
    )
    flat = dict(shape="flat", cell=1.0, lower=[0, 0], upper=[10, 10])
    assert set(np.unique(terrain(tmp_path, **flat, raised=[{"file": "b.csv"}]).elevation)) == {0.0, 3.0}


def test_steepness_is_reported():
    grid = terrain(shape="cliff", parameters={"height": 10.0, "position": 5.0}, cell=1.0, lower=[0, 0], upper=[10, 10])
    notes = " ".join(grid.notes)
    assert "steepest slope 10" in notes and "largest step between nodes 10 m" in notes
    assert "11.1 % of the bed is steeper than 0.5" in notes


def test_roughness_of_zones_and_rasters(tmp_path):
    grid = terrain(file=hill_tif(tmp_path / "a.tif", z=np.zeros((10, 12)), south_west=(0.0, 0.0)))
    (tmp_path / "road.csv").write_text("x,y\n3,3\n9,3\n9,9\n3,9\n")
    zone = {"file": "road.csv", "manning": 0.02}
    n = manning_grid(Friction(manning=0.04, zone=[zone]), grid, tmp_path)
    assert n.dtype == np.float32 and n.shape == grid.shape
    assert (n == np.float32(0.02)).sum() == 16 and n[2, 2] == np.float32(0.02) and n[0, 0] == np.float32(0.04)
    cover = np.full((10, 12), 11, np.uint8)
    cover[:, :6] = 42
    hill_tif(tmp_path / "c.tif", z=cover[:5], dtype="uint8", south_west=(0.0, 0.0))
    section = Friction(law="chezy", chezy=50.0, raster="c.tif", table={"11": 30.0, "42": 20.0})
    n = manning_grid(section, grid, tmp_path)
    assert n[0].tolist() == [20] * 6 + [30] * 6 and (n[5:] == 50).all()
