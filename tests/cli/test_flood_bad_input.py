"""Floods from the command line: bad terrain, places outside of it, bad tables, what does not go together, maps in the way."""

import json
import os
import pathlib

import numpy as np
import pytest
from small_runs import melt, refused
from test_bad_disk import disk  # noqa: F401  (a fixture)

from melt.output.checkpoint import beside
from melt.output.run_reader import open_run

SCENE = """
[scene]
name = "pond"
[time]
end = 0.2
dt = 0.1
output_every = 0.1
[terrain]
file = "bed.asc"
[fluid]
spacing = 0.5
reference_depth = 0.5
[[fluid.fill]]
lower = [0, 0]
upper = [3, 4]
depth = 0.5
"""
SHAPE = SCENE.replace('file = "bed.asc"', 'shape = "flat"\nlower = [0, 0]\nupper = [8, 4]\ncell = 0.5')
HEAD = "ncols 16\nnrows 8\nxllcorner 0\nyllcorner 0\ncellsize 0.5\n"
FLAT = HEAD + ("0 " * 16 + "\n") * 8
POOL = "lower = [0, 0]\nupper = [3, 4]"
INFLOW = "[[inflow]]\ncentre = [4, 2]\nradius = 1\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MELT_DATA", str(tmp_path / "none"))
    pathlib.Path("bed.asc").write_text(FLAT)
    return tmp_path


def written(scene):
    """Write a scene; return its path."""
    path = pathlib.Path("pond.toml")
    path.write_text(scene)
    return path


def unharmed(before, *words, said):
    """Hold that a command is refused with ``said`` and leaves the folder as it was."""
    refused(melt(*words), *said)
    assert sorted(os.listdir()) == before


# ---- terrain

TERRAINS = {
    "-9999 without a mark": (FLAT.replace("0 0 0", "0 -9999 0", 1), ["hold -9999, which is no elevation", "terrain.nodata_value = -9999"]),
    "empty": ("", ["bed.asc"]),
    "cut short": (FLAT[:-100], ["bed.asc"]),
    "words for numbers": (FLAT.replace("0 0 0", "0 high 0", 1), ["bed.asc"]),
    "all nodata": (HEAD + "NODATA_value -1\n" + ("-1 " * 16 + "\n") * 8, ["none of its 128 nodes has an elevation"]),
    "one row": (FLAT.replace("nrows 8", "nrows 1").replace("\n" + "0 " * 16, "", 7), ["make no surface"]),
    "too high": (FLAT.replace("0 0 0", "0 200000 0", 1), ["are 200000 m high", "terrain.scale"]),
    "too large": (FLAT.replace("ncols 16", "ncols 1000000"), ["bed.asc"]),
}


@pytest.mark.parametrize("command", ["plan", "run"])
@pytest.mark.parametrize("case", TERRAINS)
def test_a_bad_raster_is_refused(case, command):
    text, said = TERRAINS[case]
    pathlib.Path("bed.asc").write_text(text)
    scene = written(SCENE)
    unharmed(sorted(os.listdir()), command, scene, said=said)


def test_a_missing_raster_is_refused():
    os.remove("bed.asc")
    unharmed(["pond.toml"], "run", written(SCENE), said=["'bed.asc' does not exist", "relative to the scene"])


def test_a_terrain_in_degrees_is_refused_with_what_to_do():
    pytest.importorskip("rasterio")
    scene = written(SCENE.replace('"bed.asc"', '"bed.asc"\ncrs = "EPSG:4326"'))
    unharmed(sorted(os.listdir()), "run", scene, said=["degrees", "reproject"])


def geotiff(values):
    rasterio = pytest.importorskip("rasterio")
    with rasterio.open("bed.tif", "w", driver="GTiff", width=16, height=8, count=1, dtype="float32",
                       transform=rasterio.transform.from_origin(0, 4, 0.5, 0.5), crs="EPSG:32756") as file:
        file.write(values.astype(np.float32), 1)
    return pathlib.Path("bed.tif")


@pytest.mark.parametrize("cut", [0, 10, 300])
def test_a_corrupt_geotiff_is_refused(cut):
    path = geotiff(np.random.default_rng(1).random((8, 16)))
    path.write_bytes(path.read_bytes()[:cut])
    scene = written(SCENE.replace("bed.asc", "bed.tif"))
    unharmed(sorted(os.listdir()), "run", scene, said=["bed.tif"])


# ---- places and tables

BAD = {
    "fill outside": (SHAPE.replace(POOL, "lower = [20, 0]\nupper = [30, 4]"), ["fluid.fill 0", "outside of the terrain, (0, 0) to (8, 4)"]),
    "gauge outside": (SHAPE + "[[gauge]]\nname = 'weir'\nposition = [8.1, 2]\n", ["gauge 'weir'", "outside of the terrain"]),
    "inflow outside": (SHAPE + INFLOW.replace("[4, 2]", "[9, 2]") + "discharge = 1\n", ["inflow 'inflow 0'", "outside of the terrain"]),
    "inflow half outside": (SHAPE + INFLOW.replace("[4, 2]", "[7.5, 2]") + "discharge = 1\n", ["inflow 'inflow 0'", "outside of"]),
    "obstacle outside": (SHAPE + "[[obstacle]]\nshape='cylinder'\ncentre=[20,2]\nradius=1\n", ["obstacle 0", "outside of the terrain"]),
    "fill below the bed": (SHAPE.replace("4]\ndepth = 0.5", "4]\nstage = -2"), ["fluid.fill 0"]),
    "unknown key": (SHAPE + "[friction]\nmaning = 0.03\n", ["friction.maning is not a known key", "did you mean 'manning'"]),
    "unknown section": (SHAPE + "[bondary]\nwest = 'open'\n", ["bondary is not a known key", "did you mean 'boundary'"]),
    "unknown key of a gauge": (SHAPE + "[[gauge]]\nplace = [1, 1]\n", ["gauge.0.place is not a known key", "position is required"]),
    **{f"flood with [{name}]": (f"{SHAPE}\n[{name}]\n", [f"has no [{name}]", "carry a depth and a horizontal velocity", "[[obstacle]]"])
       for name in ("heat", "viscosity", "boiling")},
    "section of a liquid": (SHAPE + "[domain]\nupper = [1, 1, 1]\n", ["domain is not a known key"]),
    "unknown shape": (SHAPE.replace('"flat"', '"flatt"'), ["did you mean 'flat'"]),
    "unknown parameter": (SHAPE.replace("cell = 0.5", "cell = 0.5\nparameters = {hight = 3}"), ["no parameter 'hight'"]),
    "unknown profile": (SHAPE.replace("4]\ndepth = 0.5", '4]\nprofile = "thaker_radial"'), ["did you mean 'thacker_radial'"]),
    "unknown preset": (SHAPE.replace("[scene]", 'preset = "papr"\n[scene]'), ["did you mean paper"]),
    "unit of another kind": (SHAPE + INFLOW + "discharge = '3 m/s'\n", ["inflow.0.discharge"]),
    "no water depth": (SHAPE.replace("4]\ndepth = 0.5", "4]"), ["exactly one of depth, stage and profile"]),
    "two depths": (SHAPE.replace("4]\ndepth = 0.5", "4]\ndepth = 0.5\nstage = 1"), ["exactly one of depth, stage and profile"]),
    "no place of an inflow": (SHAPE + "[[inflow]]\ndischarge = 1\n", ["give one place"]),
    "two places of an inflow": (SHAPE + INFLOW + "line = [[1, 1], [1, 2]]\ndischarge = 1\n", ["give one place"]),
    "gauges of one name": (SHAPE + "[[gauge]]\nname='a'\nposition=[1,1]\n" * 2, ["'a' is given twice"]),
    "two edges on a side": (SHAPE + "[[edge]]\nside='west'\ndepth=1\n" * 2, ["'west' is given twice"]),
    "edge without a value": (SHAPE + "[[edge]]\nside='west'\n", ["give one of stage, depth and discharge"]),
    "linear and constrained": (SHAPE + "[solver]\nform='linear'\nbed='constrained'\n", ["constrained needs form"]),
    "balanced and constrained": (SHAPE + "[solver]\nform='balanced'\nbed='constrained'\n", ["constrained needs form"]),
    "chezy without its coefficient": (SHAPE + "[friction]\nlaw='chezy'\n", ["law = chezy needs chezy"]),
    "limits the wrong way round": (SHAPE + "[solver]\nsupport_limits=[5, 0.25]\n", ["support_limits"]),
    "slopes the wrong way round": (SHAPE + "[control]\nslope_on=0.6\nslope_full=0.3\n", ["slope_full"]),
    "raster of an unknown kind": (SHAPE + "[output]\nraster='png'\n", ["output.raster", "tif"]),
    "table that does not ascend": (SHAPE + INFLOW + "discharge={table=[[5,1],[0,2]]}\n", ["inflow", "sort"]),
    "table without rows": (SHAPE + INFLOW + "discharge={table=[]}\n", ["inflow"]),
    "no hydrograph": (SHAPE + INFLOW + "discharge={file='q.csv'}\n", ["q.csv", "cannot be read"]),
    "no time": (SHAPE.replace("[time]\nend = 0.2\ndt = 0.1\noutput_every = 0.1\n", ""), ["time is required and missing"]),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_flood_is_refused_and_leaves_no_file(case):
    text, said = BAD[case]
    scene = written(text)
    unharmed(["bed.asc", "pond.toml"], "run", scene, "-b", "cpu", said=said)


@pytest.mark.parametrize(
    ("text", "said"),
    [("t,q\n0,1\n1,many\n", "line 3"), ("0,1\n1\n", "line 2"), ("0,1\n5,2\n4,3\n", "sort"), ("t,q\n", "no line"), ("0,nan\n", "finite")],
)
def test_a_wrong_hydrograph_is_refused_with_its_line(text, said):
    pathlib.Path("q.csv").write_text(text)
    unharmed(["bed.asc", "pond.toml", "q.csv"], "run", written(SHAPE + INFLOW + "discharge={file='q.csv'}\n"), said=["q.csv", said])


# ---- outputs

MAPS = ("arrival_time", "final_column", "final_depth", "largest_depth", "largest_flux", "largest_speed", "wet_time")
BESIDE = sorted([f"pond_{name}.asc" for name in MAPS] + ["pond_terrain.vtkhdf"])
RUN = ["run", "pond.toml", "-b", "cpu", "--set", "output.raster=asc"]


def test_maps_stand_beside_the_run_and_are_replaced_only_when_asked_for():
    written(SHAPE + "[[gauge]]\nposition = [2, 2]\n")
    pathlib.Path("pond_largest_depth.asc").write_text("a year of work")
    before = sorted(os.listdir())
    unharmed(before, *RUN, said=["pond_largest_depth.asc exists already and was left as it is", "--overwrite"])
    assert pathlib.Path("pond_largest_depth.asc").read_text() == "a year of work"
    done = melt(*RUN, "--overwrite")
    assert done.exit_code == 0, done.output
    assert "terrain for ParaView: pond_terrain.vtkhdf" in done.stderr and "pond_NAME.asc" in done.stderr
    assert sorted(os.listdir()) == sorted([*BESIDE, "bed.asc", "pond.toml", "pond.vtkhdf", "pond.vtkhdf.ckpt"])
    assert pathlib.Path("pond_largest_depth.asc").read_text().startswith("ncols")
    told = melt("info", "pond.vtkhdf").stdout
    assert "gauges" in told and "1, 3 readings each" in told
    assert "map largest depth" in told and "16 x 8 nodes, 0 .. 0.5" in told and "m/s" in told


def test_a_scene_can_do_without_maps():
    written(SHAPE)
    assert melt(*RUN[:-1], "output.maps=false").exit_code == 0
    assert sorted(os.listdir()) == ["bed.asc", "pond.toml", "pond.vtkhdf", "pond.vtkhdf.ckpt"]


def test_a_disk_that_fills_up_at_the_maps_keeps_the_run(disk):  # noqa: F811
    scene = written(SHAPE.replace("cell = 0.5", "cell = 0.05"))
    done = melt("run", scene, "-o", disk.path / "pond.vtkhdf", "-b", "cpu", "--set", "output.raster=asc")
    refused(done, "the disk is full", "melt resume")
    with open_run(disk.path / "pond.vtkhdf") as run:
        assert len(run) == 3
    assert not [name for name in os.listdir(disk.path) if name.endswith(".part")]
    assert beside(disk.path / "pond.vtkhdf").exists()


# ---- commands that tell


def test_plan_show_and_scenes_know_floods():
    scene = written(SHAPE + INFLOW + "discharge = 1\n[control]\n[[gauge]]\nposition = [2, 2]\n")
    told = melt("plan", scene)
    assert told.exit_code == 0, told.output
    for words in ("water: 6 m^3 at the start, 0.2 m^3 flow in", "control_brake", "flood_depth", "flood_sample", "time step bound wave",
                  "terrain shape 'flat': 16 x 8 nodes", "columns of 0.125 m^3"):
        assert words in told.stdout
    shown = melt("show", scene)
    assert 'mode = "descent"' in shown.stdout and "slope_on = 0.3" in shown.stdout
    pathlib.Path("again.toml").write_text(shown.stdout)
    assert melt("show", "again.toml").stdout == shown.stdout
    listed = melt("scenes").stdout
    assert all(name in listed for name in ("ritter", "rough_terrain", "obstacles", "valley_flood"))
    schema = json.loads(melt("schema").stdout)
    assert "FloodScene" in schema["$defs"] and "Hydrograph" not in schema["$defs"]
