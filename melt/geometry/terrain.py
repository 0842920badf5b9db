"""Terrain as the flood sees it: bed elevations at the nodes of a regular grid, in a local frame.

The local frame takes an integer origin off world coordinates in float64 (a UTM northing has half a metre of
resolution in float32) and the lowest bed as datum off elevations; only writers add them back.
"""

import functools
from dataclasses import dataclass, field

import numpy as np

from melt.errors import GeometryError
from melt.geometry import terrain_shapes, terrain_zones
from melt.geometry.shapes import affordable
from melt.geometry.terrain_files import Raster, find_file, read_raster
from melt.geometry.terrain_nodata import apply_policy, mark_nodata
from melt.geometry.terrain_warp import jacksboro, north_up, refuse_degrees, reproject, resample

FOOT = {"m": 1.0, "ft": 0.3048, "us-ft": 1200 / 3937}
FAR = np.float32(1e9)  # [m] distance to walls where there are none


@dataclass
class TerrainGrid:
    """Bed at nodes (j, i), row 0 south. Lengths in m; plane coordinates are (2, ...) or pairs, component first."""

    elevation: np.ndarray  # (ny, nx) float64 [m] above the datum; finite everywhere
    blocked: np.ndarray  # (ny, nx) bool: water does not enter
    open: np.ndarray  # (ny, nx) bool: water leaves
    lower: tuple  # (x0, y0) local centre of node (0, 0)
    cell: tuple  # (dx, dy)
    origin: tuple  # integers (X0, Y0) taken off world coordinates [m]
    datum: float  # taken off elevations [m]
    transform: tuple  # affine (a, b, c, d, e, f) of the raster, north-up: for writers
    crs: str | None = None  # WKT
    unit: float = 1.0  # metres per unit of world coordinates (a reference system may be in feet)
    sampler: str = "bspline"
    name: str = "terrain"
    notes: list = field(default_factory=list)

    @property
    def shape(self):
        """(ny, nx)."""
        return self.elevation.shape

    @property
    def bounds(self):
        """Local extent, cell edge to cell edge: [[x low, y low], [x high, y high]]."""
        low = np.array(self.lower) - 0.5 * np.array(self.cell)
        return np.stack([low, low + np.array(self.shape[::-1]) * self.cell])

    @property
    def x(self):
        """Local x of the columns (nx,)."""
        return self.lower[0] + self.cell[0] * np.arange(self.shape[1])

    @property
    def y(self):
        """Local y of the rows (ny,)."""
        return self.lower[1] + self.cell[1] * np.arange(self.shape[0])

    def world(self, x):
        """Return world coordinates (float64, in the unit of the reference system) of local ones."""
        x = np.asarray(x, dtype=np.float64)
        return (x + _column(self.origin, x)) / self.unit

    def local(self, x):
        """Return local coordinates [m] of world ones."""
        x = np.asarray(x, dtype=np.float64)
        return x * self.unit - _column(self.origin, x)

    def node(self, x):
        """Return (row, column) of the nodes nearest to local points; they may lie outside of the grid."""
        x = np.asarray(x, dtype=np.float64)
        i, j = np.floor((x - _column(self.lower, x)) / _column(self.cell, x) + 0.5).astype(np.int64)
        return j, i

    @functools.cached_property
    def wall_distance(self):
        """Signed distance (ny, nx) float32 [m] to the edge of blocked cells, positive outside; `FAR` without any."""
        if not self.blocked.any():
            return np.full(self.shape, FAR, np.float32)
        outside = _to_cells(self.blocked, self.cell)
        if not self.blocked.all():
            outside -= _to_cells(~self.blocked, self.cell)
        return outside


def load_terrain(section, folder=None):
    """Return the `TerrainGrid` of a `melt.scene.terrain.Terrain`; files may stand in ``folder``.

    Raises:
        GeometryError: no file, not readable, no elevations, degrees, a rotated raster, unmarked nodata.
    """
    cell = None if section.cell is None else tuple(np.broadcast_to(np.asarray(section.cell, float), 2))
    if section.shape is not None:
        return _from_shape(section, cell, folder)
    clip = (section.lower, section.upper)
    if section.source is not None:
        raster, metres = jacksboro()
    else:
        path, metres = find_file(section.file, folder), None
        windowed = not (section.reproject or section.resample)
        raster = read_raster(path, cell, clip if windowed and clip != (None, None) else None)
    raster.crs = section.crs or raster.crs
    if min(raster.values.shape, default=0) == 0:
        raise _outside(raster, section)
    mark_nodata(raster, section.nodata_value)
    _to_metres(raster, section)
    if section.reproject:
        raster, metres = reproject(raster, section.reproject), None
    raster = north_up(raster, bool(section.resample))
    unit = 1.0
    if metres is not None:
        raster.notes.append("world coordinates are metres from the south-west corner; rasters are written in degrees")
    else:
        unit = refuse_degrees(raster, section.crs is not None)
        metres = tuple(unit * t for t in raster.transform)
    if section.resample and section.resample is not True:
        raster, metres = resample(raster, metres, section.resample)
    return _finish(section, raster, metres, unit, folder)


def _from_shape(section, cell, folder):
    """Sample an analytic bed at cell centres; the extent is a whole number of cells."""
    lower, size = np.array(section.lower), np.subtract(section.upper, section.lower)
    count = np.maximum(np.floor(size / cell + 0.5), 1)
    affordable(count.prod(), f"terrain.shape {section.shape!r}, nodes of terrain.cell")
    count = count.astype(np.int64)
    notes = []
    if (np.abs(count * cell - size) > 1e-6 * np.array(cell)).any():
        notes.append(f"upper is {_pair(lower + count * cell)}, a whole number of cells from lower")
    x, y = (lower[k] + (np.arange(count[k]) + 0.5) * cell[k] for k in range(2))
    values = terrain_shapes.sample(section.shape, x, y, section.parameters)
    transform = (cell[0], 0.0, lower[0], 0.0, -cell[1], lower[1] + count[1] * cell[1])
    raster = Raster(values[::-1], transform, None, f"shape {section.shape!r}", notes=notes)
    section = section.model_copy(update={"lower": None, "upper": None})
    return _finish(section, raster, transform, 1.0, folder)


def _to_metres(raster, section):
    """Apply scale, offset and unit of the elevations in place."""
    scale = raster.scale if section.scale is None else section.scale
    offset = raster.offset if section.offset is None else section.offset
    unit = section.vertical_unit or raster.unit
    if (scale, offset) != (1.0, 0.0):
        raster.values *= scale
        raster.values += offset
        raster.notes.append(f"elevations are {scale:g} times the stored values plus {offset:g}")
    if unit != "m":
        raster.values *= FOOT[unit]
        raster.notes.append(f"elevations turned from {unit} to m")
    # no ground is 100 km high: what is left of such values is a mark in disguise
    high = np.abs(raster.values) > 1e5
    if high.any():
        worst = raster.values[high][0]
        raise GeometryError(
            f"{raster.name}: {int(high.sum())} nodes are {worst:g} m high: set terrain.nodata_value if they mark "
            "nodes without elevation, or terrain.scale if elevations are stored in small units"
        )


def _finish(section, raster, metres, unit, folder):
    """Clip, treat nodata, raise buildings and go local; ``metres`` is the transform in metres, north-up."""
    values, metres, transform = _clip(section, raster, metres, unit)
    notes = list(raster.notes)
    ny, nx = values.shape
    if min(ny, nx) < 3:
        raise GeometryError(
            f"{raster.name}: {nx} x {ny} nodes make no surface: a terrain needs 3 along both axes; "
            "widen terrain.lower and terrain.upper, or repeat its row"
        )
    cell = (metres[0], -metres[4])
    edge = np.array([metres[2], metres[5] + ny * metres[4]])
    values = np.ascontiguousarray(values[::-1])  # row 0 south from here on
    blocked, opened = apply_policy(values, section.nodata, cell, raster.name, notes)
    far = np.abs([edge, edge + np.array([nx, ny]) * cell]).max() > 4 * max(nx * cell[0], ny * cell[1])
    # coordinates near 0 keep their numbers: the origin moves only where it costs precision
    origin = np.floor(edge) if far else np.zeros(2)
    grid = TerrainGrid(
        values, blocked, opened, tuple(np.round(edge - origin + 0.5 * np.array(cell), 12).tolist()), tuple(map(float, cell)),
        tuple(origin.tolist()), 0.0, tuple(map(float, transform)), raster.crs, unit, section.sampler, raster.name, notes,
    )  # fmt: skip
    notes.append(f"{nx} x {ny} nodes, cells of {cell[0]:.6g} x {cell[1]:.6g} m")
    terrain_zones.steepness(grid)
    terrain_zones.raise_nodes(grid, section.raised, folder)
    if grid.blocked.all():
        raise GeometryError(f"{raster.name}: every node is a wall, no water fits in: check terrain.raised")
    grid.datum = float(values[~grid.blocked].min())
    values -= grid.datum
    notes.append(f"elevation {grid.datum:g} to {grid.datum + values[~grid.blocked].max():g} m")
    return grid


def _clip(section, raster, metres, unit):
    """Return (values, metres, transform) of the nodes within lower and upper (world coordinates)."""
    values, (a, _, c, _, e, f) = raster.values, metres
    ny, nx = values.shape
    x, y = c + a * (np.arange(nx) + 0.5), f + e * (np.arange(ny) + 0.5)
    low = np.array(section.lower or [-np.inf, -np.inf]) * unit
    high = np.array(section.upper or [np.inf, np.inf]) * unit
    slack = 1e-9 * np.array([a, -e])
    keep_x = np.nonzero((x >= low[0] - slack[0]) & (x <= high[0] + slack[0]))[0]
    keep_y = np.nonzero((y >= low[1] - slack[1]) & (y <= high[1] + slack[1]))[0]
    if len(keep_x) == 0 or len(keep_y) == 0:
        raise _outside(raster, section, np.array([x[0], y[-1], x[-1], y[0]]) / unit)
    if (len(keep_x), len(keep_y)) != (nx, ny):
        raster.notes.append(f"clipped to {len(keep_x)} x {len(keep_y)} of {nx} x {ny} nodes")
    i, j = keep_x[0], keep_y[0]
    ta, tb, tc, td, te, tf = raster.transform
    moved = (ta, tb, tc + ta * i, td, te, tf + te * j)
    values = values[j : keep_y[-1] + 1, i : keep_x[-1] + 1]
    return values, (a, 0.0, c + a * i, 0.0, e, f + e * j), moved


def _outside(raster, section, extent=None):
    lies = "" if extent is None else f", which lies between {_pair(extent[:2])} and {_pair(extent[2:])}"
    return GeometryError(
        f"{raster.name}: no node is between terrain.lower {section.lower} and terrain.upper {section.upper}"
        f"{lies}: give world coordinates inside of it"
    )


def _to_cells(marked, cell):
    """Return the distance (ny, nx) float32 from each node to the nearest marked cell, an area and no point."""
    from scipy.ndimage import distance_transform_edt

    j, i = distance_transform_edt(~marked, sampling=(cell[1], cell[0]), return_distances=False, return_indices=True)
    j -= np.arange(marked.shape[0], dtype=j.dtype)[:, None]
    i -= np.arange(marked.shape[1], dtype=i.dtype)[None, :]
    gap_x, gap_y = (
        np.maximum(np.abs(k).astype(np.float32) - np.float32(0.5), np.float32(0.0)) * np.float32(size)
        for k, size in ((i, cell[0]), (j, cell[1]))
    )
    return np.hypot(gap_x, gap_y)


def _column(pair, x):
    return np.asarray(pair, dtype=np.float64).reshape((2,) + (1,) * (x.ndim - 1))


def _pair(values):
    return "(" + ", ".join(f"{v:.10g}" for v in values) + ")"
