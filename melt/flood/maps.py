"""Maps of a whole flood: into the run file, and as rasters that a GIS opens."""

import os

import numpy as np

from melt.fields import FIELDS
from melt.output.errors import OutputError
from melt.output.rasters import raster_suffix, write_raster
from melt.output.terrain_file import write_terrain

#: Name of a map -> (field, what stands where the water did not come).
MAPS = {
    "largest_depth": ("most_depth", 0.0),
    "largest_speed": ("most_speed", 0.0),
    "largest_flux": ("most_flux", 0.0),
    "arrival_time": ("arrival_time", np.nan),
    "wet_time": ("wet_time", 0.0),
    "final_depth": ("sample_depth", 0.0),
    "final_column": ("sample_column", 0.0),  # its sum times the area of a cell is the volume of the water
}


def maps_of(sim):
    """Return {name: array (ny, nx), row 0 south}: NaN where there is no ground, or where the water never came (arrival)."""
    nodes, terrain = sim.initial.map_nodes, sim.initial.terrain
    found = {}
    if not nodes:
        return found
    for name, (field, dry) in MAPS.items():
        values = sim.state.read(field)[:nodes].astype(np.float32).reshape(terrain.shape)
        if name == "arrival_time":
            values = np.where(values < 0, np.float32(dry), values)
        values[terrain.blocked | terrain.open] = np.nan
        found[name] = values
    return found


def begin(sim, writer):
    """Write the bed into a run file that begins: pictures are drawn on it."""
    terrain = sim.initial.terrain
    bed = np.where(terrain.blocked | terrain.open, np.nan, terrain.elevation + terrain.datum).astype(np.float32)
    writer.store({"bed": bed}, facts_of(terrain))


def facts_of(terrain):
    """Return what a reader needs to place maps: local frame, georeference."""
    return {
        "lower": list(terrain.lower), "cell": list(terrain.cell), "origin": list(terrain.origin),
        "datum": terrain.datum, "unit": terrain.unit,
        "transform": list(terrain.transform), "crs": terrain.crs or "", "rows": "south to north",
    }


def finish(sim, writer, say):
    """Write the maps of a run that ended: into its file, and beside it as rasters, if the scene wants them."""
    maps, terrain = maps_of(sim), sim.initial.terrain
    if not maps:
        return
    units = {name: FIELDS[field].unit for name, (field, _) in MAPS.items()}
    writer.store(maps, facts_of(terrain), units)
    beside, rasters = terrain_beside(writer.path), rasters_beside(sim.scene, writer.path)
    write_terrain(beside, terrain)
    say("written", message=f"terrain for ParaView: {beside}")
    for name, path in rasters.items():
        write_raster(path, maps[name], terrain, unit=units[name])
    if rasters:
        stem = f"{writer.path.with_name(writer.path.stem)}_NAME{next(iter(rasters.values())).suffix}"
        say("written", message=f"maps: {stem}, NAME = {', '.join(maps)}")


def rasters_beside(scene, run_path):
    """Return {name of a map: path} of the rasters that a run writes when it ends."""
    kind = scene.output.raster
    if kind == "none" or not scene.output.maps:
        return {}
    suffix = raster_suffix() if kind == "auto" else f".{kind}"
    return {name: run_path.with_name(f"{run_path.stem}_{name}{suffix}") for name in MAPS}


def check_beside(scene, run_path):
    """Refuse to begin a run whose maps would replace files that are there already.

    Raises:
        OutputError: names the first of them.
    """
    if not scene.output.maps:
        return
    there = [path for path in (terrain_beside(run_path), *rasters_beside(scene, run_path).values()) if os.path.lexists(path)]
    if there:
        others = f" and {len(there) - 1} more" if len(there) > 1 else ""
        raise OutputError(
            f"the map {there[0]}{others} exists already and was left as it is: name another run file with --output, replace them "
            "with --overwrite, or write none with --set output.raster=none --set output.maps=false."
        )


def terrain_beside(run_path):
    """Return where the terrain of a run file is written: ``NAME_terrain.vtkhdf``."""
    return run_path.with_name(f"{run_path.stem}_terrain.vtkhdf")
