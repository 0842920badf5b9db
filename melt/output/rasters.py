"""Rasters of a flood on the terrain's grid: GeoTIFF (rasterio) or ESRI ASCII, georeferenced as the terrain was."""

import io
import pathlib
import warnings

import numpy as np

from melt.output.errors import OutputError
from melt.output.whole import write_whole


def raster_suffix():
    """Return the suffix of rasters that can be written here: .tif with rasterio, else .asc."""
    try:
        import rasterio  # noqa: F401
    except ImportError:
        return ".asc"
    return ".tif"


def write_raster(path, values, grid, nodata=-9999.0, unit=None):
    """Write values at the nodes of a terrain; the suffix chooses: .tif, .tiff or .asc.

    The file appears whole or not at all. GeoTIFF is float32, tiled, LZW, north-up; ESRI ASCII comes with a
    .prj file where the reference system is known.

    Args:
        values: (ny, nx), row 0 south, as `melt.geometry.terrain.TerrainGrid` has them; not finite: nodata.
        grid: its transform and reference system are written.
        unit: of the values, for the GeoTIFF's band.

    Raises:
        OutputError: wrong suffix or shape, a value that is the nodata value, rasterio missing, a full disk.
    """
    path = pathlib.Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".tif", ".tiff", ".asc"):
        raise OutputError(f"cannot write {path}: the suffix of a raster must be one of .tif, .tiff, .asc.")
    values = np.asarray(values)
    if values.shape != tuple(grid.shape):
        raise OutputError(f"cannot write {path}: the values are {values.shape}, the terrain has {grid.shape} nodes.")
    north = values[::-1].astype(np.float32)  # row 0 north, as files have it
    north[~np.isfinite(north)] = np.nan
    if (north == np.float32(nodata)).any():
        raise OutputError(
            f"cannot write {path}: {int((north == np.float32(nodata)).sum())} values equal the nodata value "
            f"{nodata:g}; choose another one."
        )
    north[np.isnan(north)] = nodata
    if suffix == ".asc":
        write_whole(path, _asc(north, grid, nodata))
        if grid.crs is not None:
            write_whole(path.with_suffix(".prj"), _prj(grid.crs).encode())
    else:
        write_whole(path, _geotiff(path, north, grid, nodata, unit))


def _geotiff(path, north, grid, nodata, unit):
    """Return a GeoTIFF as bytes: made in memory, because GDAL reports a full disk late or never."""
    try:
        import rasterio
        from rasterio.io import MemoryFile
    except ImportError:
        raise OutputError(
            f"cannot write {path}: GeoTIFF needs rasterio: pip install 'melt[terrain]', or name a file .asc."
        ) from None
    ny, nx = north.shape
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        with MemoryFile() as memory:
            with memory.open(
                driver="GTiff", width=nx, height=ny, count=1, dtype="float32", nodata=nodata, crs=grid.crs,
                transform=rasterio.Affine(*grid.transform), compress="lzw", predictor=3, tiled=True,
                blockxsize=256, blockysize=256,
            ) as target:  # fmt: skip
                target.write(north, 1)
                if unit is not None:
                    target.units = (unit,)
            return bytes(memory.getbuffer())


def _asc(north, grid, nodata):
    a, _, c, _, e, f = map(float, grid.transform)
    ny, nx = north.shape
    # dx and dy are GDAL's extension for cells that are not square
    square = abs(a + e) <= 1e-9 * a
    cells = [f"cellsize {a!r}"] if square else [f"dx {a!r}", f"dy {-e!r}"]
    head = [f"ncols {nx}", f"nrows {ny}", f"xllcorner {c!r}", f"yllcorner {f + ny * e!r}", *cells]
    text = io.StringIO()
    text.write("\n".join([*head, f"NODATA_value {nodata:.9g}", ""]))
    np.savetxt(text, north, fmt="%.9g")
    return text.getvalue().encode()


def _prj(crs):
    """Return the reference system in ESRI's WKT, which .prj files use; as it is without rasterio."""
    try:
        from rasterio.crs import CRS
        from rasterio.errors import CRSError
    except ImportError:
        return crs
    try:
        return CRS.from_user_input(crs).to_wkt(version="WKT1_ESRI")
    except CRSError:
        return crs
