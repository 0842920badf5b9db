"""Polygons on a terrain: buildings and levees, zones of roughness; and how steep the bed is."""

import csv
import pathlib

import numpy as np

from melt.errors import GeometryError
from melt.geometry.terrain_files import find_file, read_raster

STEEP = 0.5  # slope beyond which depth-averaged flow is a poor model (27 degrees)


def read_polygons(path):
    """Return the polygons [(k, 2), ...] of a CSV with columns x, y, or house_id, vertex, x, y.

    Raises:
        GeometryError: columns missing, a value that is no number, a polygon of less than 3 corners.
    """
    path = pathlib.Path(path)
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file, skipinitialspace=True))
    except (OSError, ValueError, csv.Error) as error:
        raise GeometryError(f"polygons {path.name}: cannot be read ({error}); they are a CSV text file") from None
    found = list(rows[0]) if rows else []
    if not {"x", "y"} <= set(found):
        raise GeometryError(
            f"polygons {path.name}: columns x and y are needed (house_id, vertex, x, y for several polygons); "
            f"found: {', '.join(map(str, found)) or 'no rows'}"
        )
    polygons = {}
    for line, row in enumerate(rows, 2):
        try:
            corner = (int(row["vertex"]) if "vertex" in found else line, float(row["x"]), float(row["y"]))
        except (TypeError, ValueError):
            raise GeometryError(f"polygons {path.name}, line {line}: vertex, x and y must be numbers") from None
        polygons.setdefault(row.get("house_id"), []).append(corner)
    for name, corners in polygons.items():
        if len(corners) < 3:
            label = f"polygon {name!r}" if name is not None else "the polygon"
            raise GeometryError(f"polygons {path.name}: {label} has {len(corners)} corners; it needs 3 at least")
    return [np.array([c[1:] for c in sorted(corners)]) for corners in polygons.values()]


def inside(grid, polygon):
    """Return (slices, mask) of the nodes inside a polygon (k, 2) of world coordinates, its edge included.

    The slices cut the polygon's bounding box out of the grid; the mask is False everywhere where they miss it.
    """
    from skimage.draw import polygon2mask

    local = grid.local(np.asarray(polygon, dtype=np.float64).T)
    # rounded, so that corners that stand on nodes stay there whatever the subtraction left
    i, j = (np.round((local[k] - grid.lower[k]) / grid.cell[k], 7) for k in range(2))
    low = np.maximum(np.floor([j.min(), i.min()]).astype(np.int64), 0)
    high = np.minimum(np.ceil([j.max(), i.max()]).astype(np.int64) + 1, grid.shape)
    size = np.maximum(high - low, 0)
    where = tuple(slice(a, a + n) for a, n in zip(low, size))
    if min(size) == 0:
        return where, np.zeros(size, bool)
    return where, polygon2mask(tuple(size), np.stack([j - low[0], i - low[1]], axis=1))


def levee(line, width):
    """Return polygons of world coordinates that cover all points within half a ``width`` of a line."""
    line, polygons, half = np.asarray(line, float), [], 0.5 * width
    turn = np.linspace(0, 2 * np.pi, 33)[:-1]
    circle = half / np.cos(np.pi / 32) * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    for start, end in zip(line[:-1], line[1:]):
        length = np.hypot(*(end - start))
        if length > 0:
            across = half / length * np.array([start[1] - end[1], end[0] - start[0]])
            polygons.append(np.array([start + across, end + across, end - across, start - across]))
    return polygons + [corner + circle for corner in line[1:-1]]  # joints are round, ends are square


def raise_nodes(grid, raised, folder=None):
    """Lift the nodes inside polygons of `melt.scene.terrain.Raised`, or make them walls; in place."""
    for k, item in enumerate(raised):
        if item.file is not None:
            polygons = read_polygons(find_file(item.file, folder))
        else:
            width = None if item.width is None else item.width / grid.unit
            polygons = [item.polygon] if item.line is None else levee(item.line, width)
        touched, missed = np.zeros(grid.shape, bool), 0
        for polygon in polygons:
            where, mask = inside(grid, polygon)
            touched[where] |= mask
            missed += not mask.any()
        # all polygons of an entry act once, so that overlapping ones are not stacked
        if item.wall:
            grid.blocked |= touched
        elif item.crest is not None:
            grid.elevation[touched] = np.maximum(grid.elevation[touched], item.crest)
        else:
            grid.elevation[touched] += item.height
        done = "walls" if item.wall else f"raised {'to' if item.height is None else 'by'} "
        done += "" if item.wall else f"{item.crest if item.height is None else item.height:g} m"
        grid.notes.append(f"raised {k}: {int(touched.sum())} nodes of {len(polygons)} polygons {done}")
        if missed and item.line is None:
            grid.notes.append(
                f"raised {k}: {missed} of {len(polygons)} polygons hold no node: they lie outside, or are "
                "smaller than a cell (lower terrain.resample)"
            )


def steepness(grid):
    """Add sentences on the slope of the bed between nodes that water may reach."""
    dx, dy = grid.cell
    bins, steepest, where, jump = np.zeros(4, np.int64), -1.0, (0, 0), 0.0
    for start in range(0, grid.shape[0] - 1, 256):  # blocks of rows: the gradient needs six times the room of the bed
        rows = slice(start, start + 257)
        z = np.where(grid.blocked[rows], np.nan, grid.elevation[rows])
        east, north = np.diff(z, axis=1), np.diff(z, axis=0)
        jump = max(jump, *(np.nanmax(np.abs(d), initial=0.0) for d in (east, north)))
        slope = np.hypot(0.5 / dx * (east[1:] + east[:-1]), 0.5 / dy * (north[:, 1:] + north[:, :-1]))
        known = slope[np.isfinite(slope)]
        bins += np.histogram(known, [0.0, 0.1, STEEP, 1.0, np.inf])[0]
        if known.size and known.max() > steepest:
            j, i = np.unravel_index(np.nanargmax(slope), slope.shape)
            steepest, where = float(known.max()), (j + start, i)
    if steepest < 0:
        return
    share = 100 * bins / max(bins.sum(), 1)
    x = grid.world([grid.lower[0] + (where[1] + 0.5) * dx, grid.lower[1] + (where[0] + 0.5) * dy])
    grid.notes.append(
        f"steepest slope {steepest:.3g} at ({x[0]:.8g}, {x[1]:.9g}), largest step between nodes {jump:.4g} m"
    )
    grid.notes.append(
        f"slopes: {share[0]:.3g} % below 0.1, {share[1]:.3g} % to 0.5, {share[2]:.3g} % to 1, {share[3]:.3g} % above"
    )
    if share[2:].sum() > 0:
        grid.notes.append(
            f"{share[2:].sum():.3g} % of the bed is steeper than {STEEP}: depth-averaged flow is a poor model there"
        )


def manning_grid(section, grid, folder=None):
    """Return the roughness (ny, nx) float32 of a `melt.scene.terrain.Friction`: n, C or f by its law.

    Raises:
        GeometryError: a file that cannot be read, a land cover class without a coefficient, a negative one.
    """
    values = np.full(grid.shape, section.coefficient, np.float32)
    if section.raster is not None:
        _from_raster(section, grid, values, folder)
    for k, zone in enumerate(section.zone):
        polygons = [zone.polygon] if zone.file is None else read_polygons(find_file(zone.file, folder))
        count = 0
        for polygon in polygons:
            where, mask = inside(grid, polygon)
            values[where][mask] = getattr(zone, section.law)
            count += int(mask.sum())
        if count == 0:
            raise GeometryError(f"friction zone {k} holds no node of {grid.name}: give world coordinates inside of it, or remove the zone")
        grid.notes.append(f"friction zone {k}: {section.law} {getattr(zone, section.law):g} at {count} nodes")
    return values


def _from_raster(section, grid, values, folder):
    """Set coefficients from a raster by its nearest node; nodes outside of it keep the uniform one."""
    raster = read_raster(find_file(section.raster, folder))
    back = np.linalg.inv(np.array([raster.transform[:2], raster.transform[3:5]]))
    x = grid.world(np.stack(np.meshgrid(grid.x, grid.y)))
    x -= np.array([raster.transform[2], raster.transform[5]])[:, None, None]
    i, j = np.floor(np.einsum("ab,bji->aji", back, x)).astype(np.int64)
    there = (i >= 0) & (j >= 0) & (i < raster.values.shape[1]) & (j < raster.values.shape[0])
    found = np.full(grid.shape, np.nan)
    found[there] = raster.values[j[there], i[there]]
    if section.table is not None:
        classes = {float(k): v for k, v in section.table.items()}
        unknown = sorted(set(np.unique(found[np.isfinite(found)])) - set(classes))
        if unknown:
            raise GeometryError(
                f"{raster.name}: no coefficient for land cover class {', '.join(f'{c:g}' for c in unknown[:8])}: "
                "add it to friction.table"
            )
        covers = found.copy()
        for cover, value in classes.items():
            found[covers == cover] = value
    known = np.isfinite(found)
    if (found[known] < 0).any():
        raise GeometryError(
            f"{raster.name}: it holds the coefficient {found[known].min():g}, which must be at least 0; "
            "land cover classes need friction.table"
        )
    values[known] = found[known]
    grid.notes.append(f"friction from {raster.name} at {int(known.sum())} of {known.size} nodes")
