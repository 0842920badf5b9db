"""Rasters to metres and north-up: reprojection, rotated transforms, other cell sizes, the DEM in degrees."""

import importlib.util

import numpy as np

from melt.errors import GeometryError
from melt.geometry.terrain_files import Raster, affordable, need_rasterio

_DEGREES = ("GEOGCS", "GEOGCRS", "GEODCRS", "GEOGRAPHICCRS")


def jacksboro():
    """Return (`Raster`, its transform in metres) of the DEM that matplotlib ships: 3" of Tennessee, USGS.

    Its nodes lie in degrees; the metres are those of the WGS 84 ellipsoid at its middle, from its south-west
    corner. Across 0.29 degrees of latitude the width of a degree changes by 0.4 %.
    """
    from matplotlib import cbook

    try:
        with np.load(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as dem:
            values = dem["elevation"].astype(np.float64)
            step = (float(dem["dx"]), float(dem["dy"]))
            west, north = float(dem["xmin"]), float(max(dem["ymin"], dem["ymax"]))  # the two are swapped in it
    except (OSError, KeyError, ValueError) as error:
        raise GeometryError(
            f"terrain.source = jacksboro: matplotlib's sample data cannot be read ({error}): "
            "install matplotlib with pip, or give terrain.file"
        ) from None
    ny, _ = values.shape
    latitude = np.radians(north - 0.5 * ny * step[1])
    per_x = 111412.84 * np.cos(latitude) - 93.5 * np.cos(3 * latitude) + 0.118 * np.cos(5 * latitude)
    per_y = 111132.92 - 559.82 * np.cos(2 * latitude) + 1.175 * np.cos(4 * latitude)
    dx, dy = step[0] * per_x, step[1] * per_y
    raster = Raster(values, (step[0], 0.0, west, 0.0, -step[1], north), WGS84, "terrain source 'jacksboro'")
    return raster, (dx, 0.0, 0.0, 0.0, -dy, ny * dy)


WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],'
    'AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],'
    'UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AXIS["Latitude",NORTH],AXIS["Longitude",EAST],'
    'AUTHORITY["EPSG","4326"]]'
)


def refuse_degrees(raster, told):
    """Return metres per unit of the raster's coordinates.

    Args:
        told: the scene names the reference system, so nothing is guessed.

    Raises:
        GeometryError: the raster lies in degrees, or looks as if it did.
    """
    remedy = 'set terrain.reproject = "utm"'
    a, _, c, _, e, f = raster.transform
    if raster.crs is None:
        raster.notes.append("no reference system: coordinates are taken as metres")
        ny, nx = raster.values.shape
        within = abs(c) <= 360 and abs(c + a * nx) <= 360 and abs(f) <= 90 and abs(f + e * ny) <= 90
        if within and not told and a < 0.05 and min(nx, ny) > 1:
            rise = np.nanmedian(np.abs(np.diff(raster.values[:: max(1, ny // 512)], axis=1)))
            if rise > 20 * a:
                raise GeometryError(
                    f"{raster.name}: cells of {a:g} m with steps of {rise:.3g} m look like degrees: set "
                    'terrain.crs = "EPSG:4326" and terrain.reproject = "utm", or terrain.crs if they are metres'
                )
        return 1.0
    degrees, unit = _unit(raster)
    if degrees:
        raise GeometryError(
            f"{raster.name}: its coordinates are degrees (cells of {a:.6g} x {-e:.6g}), the flood needs metres: {remedy}"
        )
    if unit != 1.0:
        raster.notes.append(f"coordinates are in units of {unit:.10g} m and turned to metres inside")
    return unit


def _unit(raster):
    """Return (in degrees, metres per unit) of a raster's reference system."""
    text = raster.crs.strip()
    if text.upper().startswith(_DEGREES):
        return True, 1.0
    if importlib.util.find_spec("rasterio") is None:
        if "foot" in text.lower():
            need_rasterio(f"{raster.name}, in feet")
        if text.upper() == "EPSG:4326":
            return True, 1.0
        return False, 1.0
    crs = _crs(raster.crs, raster.name)
    return crs.is_geographic, 1.0 if crs.is_geographic else float(crs.linear_units_factor[1])


def _crs(text, name):
    from rasterio.crs import CRS
    from rasterio.errors import CRSError

    try:
        return CRS.from_user_input(text)
    except CRSError as error:
        raise GeometryError(f"{name}: unknown reference system {text[:60]!r} ({error}); give for instance EPSG:32617") from None


def reproject(raster, target):
    """Return the raster warped (bilinear) to ``target``: "utm", the zone of its middle, or "EPSG:..."."""
    rasterio = need_rasterio(f"terrain.reproject of {raster.name}")
    warp = rasterio.warp
    if raster.crs is None:
        raise GeometryError(
            f"{raster.name}: it names no reference system to reproject from: set terrain.crs, such as EPSG:4326"
        )
    source = _crs(raster.crs, raster.name)
    ny, nx = raster.values.shape
    transform = rasterio.Affine(*raster.transform)
    box = rasterio.transform.array_bounds(ny, nx, transform)
    try:
        if target == "utm":
            west, south, east, north = warp.transform_bounds(source, "EPSG:4326", *box)
            zone = int(((west + east) / 2 + 180) // 6) % 60 + 1
            target = f"EPSG:{(32600 if south + north >= 0 else 32700) + zone}"
        goal = _crs(target, "terrain.reproject")
        if goal.is_geographic:
            raise GeometryError(f"terrain.reproject = {target}: it is in degrees; the flood needs metres, such as utm")
        place, width, height = warp.calculate_default_transform(source, goal, nx, ny, *box)
        affordable(width * height, f"{raster.name} in {target}")
        values = np.full((height, width), np.nan)
        warp.reproject(
            raster.values, values, src_transform=transform, src_crs=source, src_nodata=np.nan,
            dst_transform=place, dst_crs=goal, dst_nodata=np.nan, resampling=warp.Resampling.bilinear,
        )  # fmt: skip
    except rasterio.errors.RasterioError as error:
        raise GeometryError(f"{raster.name}: cannot be reprojected to {target} ({error}): check terrain.crs") from None
    notes = [*raster.notes, f"reprojected to {target}, {width} x {height} nodes"]
    return Raster(values, tuple(place)[:6], goal.to_wkt(), raster.name, notes=notes)


def north_up(raster, allowed):
    """Return the raster with columns running east and rows running south.

    Raises:
        GeometryError: it is rotated, and ``allowed`` does not permit resampling.
    """
    a, b, c, d, e, f = raster.transform
    if b == 0 and d == 0:
        values = raster.values
        ny, nx = values.shape
        if a < 0:
            values, a, c = values[:, ::-1], -a, c + a * nx
        if e > 0:
            values, e, f = values[::-1], -e, f + e * ny
        return Raster(values, (a, 0.0, c, 0.0, e, f), raster.crs, raster.name, notes=raster.notes)
    angle = np.degrees(np.arctan2(d, a))
    if not allowed:
        raise GeometryError(
            f"{raster.name}: it is rotated by {angle:.3g} degrees: set terrain.resample = true to resample it "
            "to north-up, or straighten it with gdalwarp"
        )
    ny, nx = raster.values.shape
    corners = np.array([[0, nx, 0, nx], [0, 0, ny, ny]], float)
    x, y = a * corners[0] + b * corners[1] + c, d * corners[0] + e * corners[1] + f
    dx, dy = np.hypot(a, d), np.hypot(b, e)
    width, height = int(np.ceil(np.ptp(x) / dx - 1e-6)), int(np.ceil(np.ptp(y) / dy - 1e-6))
    affordable(width * height, raster.name)
    transform = (dx, 0.0, x.min(), 0.0, -dy, y.max())
    back = np.linalg.inv([[a, b], [d, e]])
    notes = [*raster.notes, f"rotated by {angle:.3g} degrees, resampled to {width} x {height} nodes north-up"]
    values = _sample(raster.values, transform, (height, width), back, (c, f))
    return Raster(values, transform, raster.crs, raster.name, notes=notes)


def resample(raster, metres, cell):
    """Return (raster, its transform in metres) with square cells of ``cell`` metres; coarser cells are means."""
    ny, nx = raster.values.shape
    factor = (cell / metres[0], cell / -metres[4])
    width, height = (max(1, round(n / k)) for n, k in zip((nx, ny), factor))
    affordable(width * height, raster.name)
    window = tuple(max(1, round(k)) for k in factor[::-1])
    values = _mean(raster.values, window)
    # a mean over an even number of nodes stands half a node before the node that holds it
    corner = tuple(-0.5 * (1 - k % 2) for k in window[::-1])
    a, _, c, _, e, f = raster.transform
    pixel = (factor[0], 0.0, 0.0, 0.0, factor[1], 0.0)
    values = _sample(values, pixel, (height, width), np.eye(2), corner)
    notes = [*raster.notes, f"resampled to {width} x {height} nodes"]
    fine = Raster(values, (a * factor[0], 0.0, c, 0.0, e * factor[1], f), raster.crs, raster.name, notes=notes)
    return fine, (cell, 0.0, metres[2], 0.0, -cell, metres[5])


def _mean(values, window):
    """Return the running mean over ``window`` nodes of what is there."""
    if window == (1, 1):
        return values
    from scipy.ndimage import uniform_filter

    there = np.isfinite(values)
    total = uniform_filter(np.where(there, values, 0.0), window, mode="nearest")
    weight = uniform_filter(there.astype(np.float64), window, mode="nearest")
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(weight > 0.5, total / weight, np.nan)


def _sample(values, transform, shape, back, corner):
    """Return bilinear values at the cell centres of ``transform``; NaN outside and beside NaN.

    ``back`` (2, 2) and ``corner`` take world coordinates to columns and rows of ``values``.
    """
    from scipy.ndimage import map_coordinates

    ny, nx = values.shape
    out = np.empty(shape)
    for start in range(0, shape[0], 256):  # blocks of rows: coordinates need three times the room of values
        rows = np.arange(start, min(start + 256, shape[0]))[:, None] + 0.5
        x = transform[0] * (np.arange(shape[1]) + 0.5)[None, :] + transform[2] - corner[0]
        y = transform[4] * rows + transform[5] - corner[1]
        column = back[0, 0] * x + back[0, 1] * y - 0.5
        row = back[1, 0] * x + back[1, 1] * y - 0.5
        outside = (column < -0.5 - 1e-6) | (column > nx - 0.5 + 1e-6) | (row < -0.5 - 1e-6) | (row > ny - 0.5 + 1e-6)
        at = np.stack([np.clip(row, 0, ny - 1), np.clip(column, 0, nx - 1)])
        block = map_coordinates(values, at, order=1, mode="nearest", prefilter=False)
        out[start : start + len(rows)] = np.where(outside, np.nan, block)
    return out
