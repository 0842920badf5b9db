"""Terrains that cannot be used: each is refused in one sentence that names the remedy."""

import tomllib

import numpy as np
import pytest
from pydantic import ValidationError
from terrain_files import hide_rasterio, hill, hill_tif, terrain, write_tif

from melt.errors import GeometryError
from melt.geometry import terrain_files as files
from melt.geometry.terrain_zones import manning_grid
from melt.scene.messages import explain
from melt.scene.quantities import Section
from melt.scene.terrain import Friction, Terrain
from melt.scene.toml import dumps

HEAD = "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n"


def refused(said, folder=None, **keys):
    with pytest.raises(GeometryError) as caught:
        terrain(folder, **keys)
    text = str(caught.value)
    for words in [said] if isinstance(said, str) else said:
        assert words in text, text
    assert "\n" not in text and text[0].islower()


def with_values(value, count=5):
    z = hill()[0]
    z.ravel()[3 : 3 + count] = value
    return z


@pytest.mark.parametrize("value", [-9999.0, -32768.0, 1e38, -3.4028235e38, 1e20])
@pytest.mark.parametrize("kind", ["tif", "npz"])
def test_marks_that_the_file_does_not_declare(value, kind, tmp_path):
    path = tmp_path / f"a.{kind}"
    if kind == "tif":
        hill_tif(path, z=with_values(value))
    else:
        _, x, y = hill()
        np.savez(path, x=x, y=y, z=with_values(value))
    refused(["5 of 48 nodes", f"{np.float32(value):g}"[:5], "terrain.nodata_value = -"[: 24 - (value > 0)]], file=str(path))
    assert terrain(file=str(path), nodata_value=value).blocked.sum() == 5


def test_marks_in_ascii_without_a_nodata_line(tmp_path):
    (tmp_path / "a.asc").write_text(HEAD + "1 2 3 4\n-9999 1 2 3\n1 2 3 4\n")
    refused(["1 of 12 nodes hold -9999", "terrain.nodata_value = -9999"], tmp_path, file="a.asc")


def test_marks_that_scaling_hides(tmp_path):
    z = np.full((6, 8), 1500.0)
    z[2, 2] = -9999
    refused("hold -9999", file=hill_tif(tmp_path / "a.tif", z=z, scales=(0.001,), offsets=(0.0,)))


def test_ground_of_a_hundred_kilometres(tmp_path):
    z = 1e6 + hill()[0]
    refused("set terrain.nodata_value if they mark", file=hill_tif(tmp_path / "a.tif", z=z))
    assert terrain(file=hill_tif(tmp_path / "b.tif", z=z), scale=0.001).datum == pytest.approx(1000, rel=0.01)


def test_nothing_but_nodata(tmp_path):
    path = hill_tif(tmp_path / "a.tif", z=np.full((6, 8), np.nan))
    for policy in ("wall", "fill", "open"):
        refused("none of its 48 nodes has an elevation", file=path, nodata=policy)
    refused("none of its", file=hill_tif(tmp_path / "b.tif", z=np.full((6, 8), -9999.0), nodata=-9999))


@pytest.mark.parametrize("shape", [(1, 8), (6, 1), (2, 8), (1, 1)])
def test_a_strip_is_no_surface(shape, tmp_path):
    said = f"{shape[1]} x {shape[0]} nodes make no surface"
    refused(said, file=hill_tif(tmp_path / "a.tif", z=np.ones(shape)))
    z, x, y = np.ones(shape), np.arange(shape[1]) + 0.5, np.arange(shape[0]) + 0.5
    np.savez(tmp_path / "a.npz", x=x, y=y, z=z)
    refused(said, file=str(tmp_path / "a.npz"))


def test_a_shape_of_one_row():
    refused("8 x 1 nodes make no surface", shape="flat", cell=1.0, lower=[0, 0], upper=[8, 1])


def test_a_rotated_raster(tmp_path):
    path = write_tif(tmp_path / "a.tif", np.ones((9, 9), np.float32), (2.0, 1.0, 0.0, 1.0, -2.0, 0.0))
    refused(["rotated by 26.6 degrees", "terrain.resample = true"], file=path)


def test_degrees(tmp_path):
    place = (1 / 1200, 0.0, -84.4, 0.0, -1 / 1200, 36.7)
    path = write_tif(tmp_path / "a.tif", np.ones((9, 9), np.float32), place, "EPSG:4326")
    refused(["degrees", 'set terrain.reproject = "utm"'], file=path)
    refused("is in degrees", file=path, reproject="EPSG:4269")
    assert "zone 16N" in terrain(file=path, reproject="utm").crs


def test_degrees_without_a_reference_system(tmp_path):
    rng = np.random.default_rng(0)
    z = rng.uniform(200, 900, (30, 30))
    path = write_tif(tmp_path / "a.tif", z, (1 / 1200, 0.0, -84.4, 0.0, -1 / 1200, 36.7), None)
    refused(["look like degrees", 'terrain.crs = "EPSG:4326"'], file=path)
    assert "zone 16N" in terrain(file=path, crs="EPSG:4326", reproject="utm").crs
    refused("names no reference system", file=path, reproject="utm")


def test_degrees_in_a_prj_file_need_no_rasterio(tmp_path, monkeypatch):
    (tmp_path / "a.asc").write_text(HEAD.replace("cellsize 1", "cellsize 0.01") + "1 2 3 4\n" * 3)
    (tmp_path / "a.prj").write_text('GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984"]]')
    hide_rasterio(monkeypatch)
    refused("its coordinates are degrees", tmp_path, file="a.asc")


def test_unknown_reference_systems(tmp_path):
    path = hill_tif(tmp_path / "a.tif")
    refused("unknown reference system 'EPSG:999999'", file=path, reproject="EPSG:999999")
    refused("unknown reference system 'moon'", file=path, crs="moon")


def test_no_georeference(tmp_path):
    path = write_tif(tmp_path / "a.tif", hill()[0], (1.0, 0, 0, 0, 1.0, 0), None)
    refused("give terrain.cell", file=path)
    assert terrain(file=path, cell=2.0).cell == (2.0, 2.0)


def test_damaged_files(tmp_path):
    whole = hill_tif(tmp_path / "whole.tif", z=np.random.default_rng(0).normal(size=(200, 200)))
    data = (tmp_path / "whole.tif").read_bytes()
    (tmp_path / "cut.tif").write_bytes(data[: len(data) // 2])
    (tmp_path / "text.tif").write_text("hello " * 99)
    (tmp_path / "empty.tif").write_bytes(b"")
    for name in ("cut.tif", "text.tif", "empty.tif"):
        refused([f"terrain file {name}", "cannot be read"], tmp_path, file=name)
    for name in ("cut.npz", "cut.npy", "cut.h5"):
        (tmp_path / name).write_bytes(data[:999])
        refused([f"terrain file {name}", "cannot be read"], tmp_path, file=name)
    assert terrain(file=whole).shape == (200, 200)


def test_files_that_are_not_there(tmp_path):
    refused("does not exist", tmp_path, file="none.tif")
    refused("is a folder", file=str(tmp_path))


def test_pictures_are_no_elevations(tmp_path):
    path = write_tif(tmp_path / "a.tif", np.ones((3, 9, 9), np.uint8), (1.0, 0, 0, 0, -1.0, 9))
    refused("a picture of 3 bands", file=path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEAD + "1 2 3 4\n5 6 7\n", "7 values can be read"),
        (HEAD + "1 2 3 4\n" * 4, "16 values can be read"),
        (HEAD + "1,5 2 3 4\n" * 3, "decimal commas"),
        (HEAD.replace("cellsize 1", "cellsize 1,5") + "1 2 3 4\n" * 3, "decimals need a point"),
        (HEAD.replace("cellsize 1\n", "") + "1 2 3 4\n" * 3, "lacks cellsize"),
        (HEAD.replace("xllcorner 0\n", "") + "1 2 3 4\n" * 3, "lacks xllcorner"),
        (HEAD.replace("cellsize 1", "cellsize -1") + "1 2 3 4\n" * 3, "greater than 0"),
        (HEAD.replace("nrows 3", "nrows nan") + "1 2 3 4\n" * 3, "nrows = nan is not finite"),
        ("", "lacks ncols"),
    ],
)
def test_bad_ascii(text, said, tmp_path):
    (tmp_path / "a.asc").write_text(text)
    refused(said, tmp_path, file="a.asc")


def test_bad_arrays(tmp_path):
    z, x, y = hill()
    cases = {
        "holds w": dict(w=z), "it holds z": dict(z=z[0], x=x, y=y), "transpose it": dict(z=z.T, x=x, y=y),
        "x is not evenly spaced": dict(z=z, x=x**2, y=y), "give terrain.cell": dict(z=z),
        "numbers": dict(z=z.astype(str), x=x, y=y), "must be (len(y), len(x)) = (1, 8)": dict(z=z, x=x, y=3.0),
        "y is not evenly spaced": dict(z=z, x=x, y=y * np.nan),
    }  # fmt: skip
    for said, parts in cases.items():
        np.savez(tmp_path / "a.npz", **parts)
        refused(said, tmp_path, file="a.npz")


def test_a_clip_beside_the_terrain(tmp_path):
    path = hill_tif(tmp_path / "a.tif")
    refused("no node is between", file=path, lower=[0, 0], upper=[10, 10])
    np.savez(tmp_path / "a.npz", **dict(zip("zxy", hill())))
    refused(["no node is between", "lies between (1, 1) and (15, 11)"], tmp_path, file="a.npz", lower=[100, 100])


def test_too_many_nodes(tmp_path, monkeypatch):
    path = hill_tif(tmp_path / "a.tif")
    monkeypatch.setattr(files, "MOST_NODES", 40)
    refused("48 nodes are more than the 40 that fit", file=path)
    assert terrain(file=path, upper=[382012, 6354010]).shape == (5, 6)


def test_without_rasterio(tmp_path, monkeypatch):
    path = hill_tif(tmp_path / "a.tif")
    (tmp_path / "a.asc").write_text(HEAD + "1 2 3 4\n" * 3)
    hide_rasterio(monkeypatch)
    refused("pip install 'melt[terrain]'", file=path)
    refused("pip install 'melt[terrain]'", source="jacksboro", reproject="utm")
    assert terrain(tmp_path, file="a.asc").shape == (3, 4)


def test_bad_polygons(tmp_path):
    flat = dict(shape="flat", cell=1.0, lower=[0, 0], upper=[9, 9])
    for text, said in (
        ("a,b\n1,2\n", "columns x and y are needed"), ("", "no rows"), ("x,y\n1,2\n3,four\n5,6\n", "line 3"),
        ("x,y\n1,2\n3,4\n", "has 2 corners"),
    ):  # fmt: skip
        (tmp_path / "b.csv").write_text(text)
        refused(said, tmp_path, **flat, raised=[{"file": "b.csv"}])
    everywhere = [[-1, -1], [99, -1], [99, 99], [-1, 99]]
    refused("every node is a wall", **flat, raised=[{"polygon": everywhere, "wall": True}])


def test_bad_roughness(tmp_path):
    grid = terrain(shape="flat", cell=2.0, lower=[0, 0], upper=[16, 12])
    hill_tif(tmp_path / "c.tif", (0.0, 0.0), z=np.full((6, 8), 11.0))
    with pytest.raises(GeometryError, match="no coefficient for land cover class 11"):
        manning_grid(Friction(raster="c.tif", table={"42": 0.1}), grid, tmp_path)
    hill_tif(tmp_path / "c.tif", (0.0, 0.0), z=np.full((6, 8), -1.0))
    with pytest.raises(GeometryError, match="must be at least 0"):
        manning_grid(Friction(raster="c.tif"), grid, tmp_path)


SHAPE = dict(shape="bump", cell=1.0, lower=[0, 0], upper=[9, 9])


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({}, "exactly one of file, source and shape; given: none"),
        (dict(file="a.tif", source="jacksboro"), "given: file, source"),
        (dict(SHAPE, shape="bmp"), "did you mean 'bump'"),
        (dict(SHAPE, parameters={"hight": 1}), "has no parameter 'hight'; did you mean 'height'"),
        (dict(SHAPE, parameters={"centre": 1}), "must be a pair"),
        (dict(SHAPE, parameters={"height": "1 kg"}), "is a mass"),
        (dict(SHAPE, parameters={"curvature": 0}), "greater than 0"),
        (dict(SHAPE, parameters={"height": float("nan")}), "not finite"),
        (dict(SHAPE, cell=None), "cell missing"),
        (dict(SHAPE, vertical_unit="ft"), "not for a shape"),
        (dict(file="a.tif", parameters={"height": 1}), "parameters belong to a shape"),
        (dict(file="a.tif", lower=[1, 1], upper=[1, 2]), "must exceed lower"),
        (dict(file="a.tif", reproject="utm33"), "must be false"),
        (dict(file="a.tif", scale=0), "a scale of 0"),
        (dict(file="a.tif", raised=[{}]), "exactly one of polygon, line and file"),
        (dict(file="a.tif", raised=[{"line": [[0, 0], [1, 1]]}]), "both line and width"),
        (dict(file="a.tif", raised=[{"file": "b.csv", "height": 1, "wall": True}]), "one of height, crest and wall"),
    ],
)
def test_sections_that_do_not_fit(keys, said):
    with pytest.raises(ValueError, match=said):
        Terrain(**keys)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        (dict(chezy=50.0), "not the coefficient of law = manning"),
        (dict(law="darcy"), "law = darcy needs darcy"),
        (dict(zone=[{"file": "a.csv"}]), "zone 0 needs manning"),
        (dict(zone=[{"manning": 0.1}]), "either polygon or file"),
        (dict(table={"1": 0.1}), "needs their raster"),
        (dict(raster="a.tif", table={"forest": 0.1}), "not a number"),
    ],
)
def test_friction_that_does_not_fit(keys, said):
    with pytest.raises(ValueError, match=said):
        Friction(**keys)


class _Flood(Section):
    terrain: Terrain
    friction: Friction | None = None


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ({"terrain": {"fil": "a.tif"}}, "terrain.fil is not a known key; did you mean 'file'?"),
        ({"terrain": {"file": "a.tif", "raise": []}}, "terrain.raise is not a known key; did you mean 'raised'?"),
        ({"terrain": {"file": "a.tif", "nodata": "hole"}}, "terrain.nodata = 'hole' is not allowed"),
        ({"terrain": {"file": "a.tif", "lower": [1]}}, "a list of 2 values"),
        ({"terrain": {"file": "a.tif", "resample": "no"}}, "terrain.resample = 'no' is not allowed"),
        ({"terrain": {"file": "a.tif", "cell": -1}}, "greater than 0"),
        ({"terrain": {"file": "a.tif", "raised": [{"polygn": []}]}}, "terrain.raised.0.polygn is not a known key"),
        ({"terrain": {"file": "a.tif", "raised": [{"polygon": [[0, 0], [1, 1]]}]}}, "terrain.raised.0.polygon"),
        ({"terrain": {"file": "a.tif"}, "friction": {"maning": 1}}, "did you mean 'manning'?"),
        ({"terrain": {"shape": "flat", "cell": 1, "lower": [0, 0], "upper": [1, 1], "parameters": {"x": 1}}}, "it takes height"),
    ],
)  # fmt: skip
def test_keys_are_refused_in_words(data, said):
    with pytest.raises(ValidationError) as caught:
        _Flood.model_validate(data)
    assert said in explain(caught.value, data, "scene x", _Flood)


def test_sections_come_back_from_toml_and_have_a_schema():
    data = {
        "terrain": {
            "shape": "bump", "parameters": {"centre": [1.0, 2.0], "height": "20 cm"}, "cell": [1.0, 2.0],
            "lower": [0, 0], "upper": [9, 8], "raised": [{"line": [[0, 1], [2, 3]], "width": 1, "crest": 4}],
        },
        "friction": {"manning": 0.04, "zone": [{"polygon": [[0, 0], [1, 0], [1, 1]], "manning": 0.02}]},
    }  # fmt: skip
    section = _Flood.model_validate(data)
    assert section.terrain.parameters == {"centre": [1.0, 2.0], "height": 0.2}
    again = _Flood.model_validate(tomllib.loads(dumps(section.model_dump(exclude_none=True))))
    assert again == section
    assert "nodata_value" in _Flood.model_json_schema()["$defs"]["Terrain"]["properties"]
