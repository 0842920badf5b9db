"""Maps of a whole flood: into the run file, and as rasters that a GIS opens."""

import numpy as np

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
        "lower": list(terrain.lower), "cell": list(terrain.cell), "origin": list(terrain.origin), "datum": terrain.datum,
        "transform": list(terrain.transform), "crs": terrain.crs or "", "rows": "south to north",
    }


def finish(sim, writer, say):
    """Write the maps of a run that ended: into its file, and beside it as rasters, if the scene wants them."""
    maps, terrain = maps_of(sim), sim.initial.terrain
    if not maps:
        return
    writer.store(maps, facts_of(terrain))
    beside = terrain_beside(writer.path)
    write_terrain(beside, terrain)
    say("written", message=f"terrain for ParaView: {beside}")
    kind = sim.scene.output.raster
    if kind == "none":
        return
    suffix = raster_suffix() if kind == "auto" else f".{kind}"
    for name, values in maps.items():
        write_raster(writer.path.with_name(f"{writer.path.stem}_{name}{suffix}"), values, terrain)
    say("written", message=f"maps: {writer.path.with_name(writer.path.stem)}_NAME{suffix}, NAME = {', '.join(maps)}")


def terrain_beside(run_path):
    """Return where the terrain of a run file is written: ``NAME_terrain.vtkhdf``."""
    return run_path.with_name(f"{run_path.stem}_terrain.vtkhdf")
