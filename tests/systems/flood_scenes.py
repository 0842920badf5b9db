"""Small floods at the limits: some hundred columns on a few nodes of terrain, in double precision."""

import numpy as np
from extreme_scenes import merged

from melt.scene import scene_from_dict

R0, DEPTH = 0.4, 0.5
BASE = {
    "time": {"end": 1.0, "dt": 0.05, "n_sub_max": 200},
    "terrain": {"shape": "flat", "lower": [0.0, 0.0], "upper": [8.0, 4.0], "cell": 0.5},
    "fluid": {
        "spacing": R0, "reference_depth": DEPTH, "seed": 1,
        "fill": [{"lower": [0.0, 0.0], "upper": [3.0, 4.0], "depth": DEPTH}],
    },
    "solver": {"precision": "double"},
    "output": {"maps": False},
}
ALL_OPEN = dict.fromkeys(("west", "east", "south", "north"), "open")
PLAIN = {"lower": [-50.0, -50.0], "upper": [50.0, 50.0], "cell": 1.0}  # so far that its walls are not felt


def flood(**sections):
    """Return the base scene with sections changed (dictionaries merge, lists replace, None removes)."""
    return scene_from_dict(merged(BASE, sections))


def raster(folder, values, cell=0.5, mark=None):
    """Write elevations (ny, nx), row 0 north, as ESRI ASCII in ``folder``; return the path."""
    ny, nx = np.shape(values)
    head = f"ncols {nx}\nnrows {ny}\nxllcorner 0\nyllcorner 0\ncellsize {cell}\n" + ("" if mark is None else f"NODATA_value {mark}\n")
    path = folder / "bed.asc"
    path.write_text(head + "\n".join(" ".join(f"{v:.9g}" for v in row) for row in values) + "\n")
    return path


def from_file(path, **terrain):
    """Return the terrain section of a raster file, in place of the base scene's shape."""
    return {"shape": None, "lower": None, "upper": None, "cell": None, "file": str(path), **terrain}


def sound(sim):
    """Hold that all is finite and the volume kept; return the ledgers."""
    s = sim.series()
    assert all(np.isfinite(values).all() for values in sim.frame().values())
    assert all(np.isfinite(value) for value in s.values())
    assert abs(s["volume_error"]) <= 1e-12
    return s


def water(sim, name):
    """Return a field of the columns that are on the terrain, in order of id."""
    return sim.read(name)[sim.read("phase") == 0]


def watched(sim, steps):
    """Step; return the warnings that a run would give, in order, without repeats."""
    told = []
    for _ in range(steps):
        sim.step()
        if sim.do.warning and sim.do.warning not in told:
            told.append(sim.do.warning)
    return told
