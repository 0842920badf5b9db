"""Rasters from files: GeoTIFF (rasterio), ESRI ASCII, NumPy and HDF5, as values with a georeference.

Registration: a GeoTIFF's transform is of cell corners and values stand at cell centres; ESRI ASCII says
``xllcorner`` or ``xllcenter``; ``x`` and ``y`` of NumPy and HDF5 files are centres.
"""

import pathlib
import warnings
from dataclasses import dataclass, field

import numpy as np

from melt.errors import GeometryError
from melt.paths import is_file

MOST_NODES = 100_000_000  # of one raster (0.8 GB); more is a whole country and needs a clip
_FEET = {"ft": "ft", "foot": "ft", "feet": "ft", "us-ft": "us-ft", "us survey foot": "us-ft", "ussurveyfoot": "us-ft"}


@dataclass
class Raster:
    """Values of a raster, row 0 north as in files, not finite where there is none."""

    values: np.ndarray  # (ny, nx) float64, as stored: scale, offset and unit are not applied
    transform: tuple  # affine (a, b, c, d, e, f) of corners: x = a col + b row + c, y = d col + e row + f
    crs: str | None = None  # WKT
    name: str = "terrain"
    scale: float = 1.0
    offset: float = 0.0
    unit: str = "m"  # of the elevations
    notes: list = field(default_factory=list)


def find_file(name, folder=None):
    """Return the path of a terrain file: beside the scene, or as it is.

    Raises:
        GeometryError: there is none.
    """
    places = [pathlib.Path(folder) / name] if folder is not None else []
    for path in [*places, pathlib.Path(name)]:
        if is_file(path):
            return path
        if is_file(path, folder=True):
            raise GeometryError(f"terrain file {str(name)!r} is a folder: name the file inside it")
    raise GeometryError(f"terrain file {str(name)!r} does not exist: give a path, absolute or relative to the scene")


def read_raster(path, cell=None, window=None):
    """Return the `Raster` of a file.

    Args:
        path: its suffix says how: .asc, .npz, .npy, .h5, .hdf5; all others are rasterio's.
        cell: (dx, dy) for files without coordinates.
        window: (lower, upper) in world coordinates; a GeoTIFF is read within them only.

    Raises:
        GeometryError: not readable, no elevations, coordinates that are not even.
    """
    path = pathlib.Path(path)
    suffix = path.suffix.lower()
    try:
        if suffix == ".asc":
            return _read_asc(path)
        if suffix in (".npz", ".npy"):
            return _read_numpy(path, cell)
        if suffix in (".h5", ".hdf5"):
            return _read_hdf5(path, cell)
        return _read_rasterio(path, cell, window)
    except OSError as error:
        raise GeometryError(f"terrain file {path.name}: cannot be read ({error}); is it whole?") from None
    except MemoryError:
        raise GeometryError(
            f"terrain file {path.name}: too large for the memory of this machine; clip it (gdal_translate -projwin)"
        ) from None


def need_rasterio(path):
    """Return the module rasterio; `GeometryError` that says how to install it."""
    try:
        import rasterio
        import rasterio.warp
    except ImportError:
        raise GeometryError(
            f"{path}: this needs rasterio, which is not installed: pip install 'melt[terrain]', "
            "or convert the file to ESRI ASCII (gdal_translate -of AAIGrid)"
        ) from None
    return rasterio


def affordable(nodes, name):
    """Refuse rasters of more than `MOST_NODES` nodes before anything is read."""
    if nodes > MOST_NODES:
        raise GeometryError(
            f"{name}: {nodes:,} nodes are more than the {MOST_NODES:,} that fit: clip it with "
            "terrain.lower and terrain.upper, or coarsen it with terrain.resample"
        )


def _read_rasterio(path, cell, window):
    rasterio = need_rasterio(f"terrain file {path.name}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        try:
            with rasterio.open(path) as source:
                return _from_rasterio(source, path, cell, window)
        except rasterio.errors.RasterioError as error:
            raise GeometryError(
                f"terrain file {path.name}: cannot be read ({error}); it is damaged, cut short, or no raster"
            ) from None


def _from_rasterio(source, path, cell, window):
    from rasterio.windows import Window

    if source.count in (3, 4) and source.dtypes[0] == "uint8":
        raise GeometryError(f"terrain file {path.name}: it is a picture of {source.count} bands, not elevations")
    if "complex" in source.dtypes[0]:
        raise GeometryError(f"terrain file {path.name}: its values are complex numbers, not elevations")
    transform, notes = tuple(source.transform)[:6], []
    if source.transform.is_identity and source.crs is None:
        transform = _placed(source.height, path, cell, notes)
    first, shape = (0, 0), (source.height, source.width)
    if window is not None and transform[1] == transform[3] == 0:
        first, shape = _rows_within(transform, shape, window)
    affordable(shape[0] * shape[1], f"terrain file {path.name}")
    a, b, c, d, e, f = transform
    band = source.read(1, window=Window(first[1], first[0], shape[1], shape[0]), masked=True)
    values = band.data.astype(np.float64)
    values[np.ma.getmaskarray(band)] = np.nan
    if source.count > 1:
        notes.append(f"band 1 of {source.count} is taken")
    unit = (source.units[0] or "m").lower()
    return Raster(
        values,
        (a, b, c + a * first[1], d, e, f + e * first[0]),
        source.crs.to_wkt() if source.crs else None,
        path.name,
        source.scales[0],
        source.offsets[0],
        _FEET.get(unit, "m"),
        notes,
    )


def _rows_within(transform, shape, window):
    """Return ((first row, first column), (rows, columns)) of cells with their centre within a clip."""
    first, count = [], []
    for axis, (step, start) in enumerate(((transform[4], transform[5]), (transform[0], transform[2]))):
        ends = [corner[1 - axis] if corner is not None else None for corner in window]
        # half a cell: centre k is at start + (k + 1/2) step
        at = [None if e is None else (e - start) / step - 0.5 for e in ends]
        if step < 0:
            at = at[::-1]
        n = shape[axis]
        k0 = 0 if at[0] is None else int(np.clip(np.ceil(at[0] - 1e-9), 0, n))
        k1 = n if at[1] is None else int(np.clip(np.floor(at[1] + 1e-9) + 1, k0, n))
        first.append(k0)
        count.append(k1 - k0)
    return tuple(first), tuple(count)


def _placed(rows, path, cell, notes):
    """Return the transform of a raster without coordinates: its south-west corner is (0, 0)."""
    if cell is None:
        raise GeometryError(
            f"terrain file {path.name}: it says neither where it lies nor how large its cells are: "
            "give terrain.cell, for instance 1.0 (m)"
        )
    notes.append(f"no georeference: the south-west corner is (0, 0), cells are {cell[0]:g} x {cell[1]:g} m")
    return (cell[0], 0.0, 0.0, 0.0, -cell[1], rows * cell[1])


def _read_asc(path):
    """Read ESRI ASCII; the file ``NAME.prj`` beside it names the reference system."""
    text = path.read_text(encoding="latin-1")
    head, at = {}, 0
    while True:
        end = text.find("\n", at)
        words = text[at : end if end >= 0 else len(text)].split()
        if len(words) != 2 or not words[0][0].isalpha() or words[0].lower() in ("nan", "inf"):
            break
        try:
            head[words[0].lower()] = float(words[1])
        except ValueError:
            raise GeometryError(
                f"terrain file {path.name}: {words[0]} = {words[1]!r} is not a number; decimals need a point"
            ) from None
        at = end + 1 if end >= 0 else len(text)
    missing = [k for k in ("ncols", "nrows") if k not in head]
    missing += [f"{c}llcorner (or {c}llcenter)" for c in "xy" if not {f"{c}llcorner", f"{c}llcenter"} & set(head)]
    missing += [] if "cellsize" in head or {"dx", "dy"} <= set(head) else ["cellsize (or dx and dy)"]
    if missing:
        raise GeometryError(f"terrain file {path.name}: its header lacks {', '.join(missing)}; is it ESRI ASCII?")
    if odd := [k for k, v in head.items() if not np.isfinite(v) and k != "nodata_value"]:
        raise GeometryError(f"terrain file {path.name}: {odd[0]} = {head[odd[0]]} is not finite")
    nx, ny = int(head["ncols"]), int(head["nrows"])
    affordable(nx * ny, f"terrain file {path.name}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # old NumPy warns and stops at text, new raises
        try:
            values = np.fromstring(text[at:], sep=" ")
        except ValueError:
            values = np.zeros(0)
    if values.size != nx * ny:
        raise GeometryError(
            f"terrain file {path.name}: {values.size or 'not all'} values can be read, ncols x nrows = {nx} x {ny} "
            f"= {nx * ny} are promised: it is cut short, or holds text or decimal commas"
        )
    dx, dy = head.get("dx", head.get("cellsize")), head.get("dy", head.get("cellsize"))
    if not (dx > 0 and dy > 0):
        raise GeometryError(f"terrain file {path.name}: cells of {dx:g} x {dy:g}; cellsize must be greater than 0")
    west = head["xllcorner"] if "xllcorner" in head else head["xllcenter"] - 0.5 * dx
    south = head["yllcorner"] if "yllcorner" in head else head["yllcenter"] - 0.5 * dy
    if "nodata_value" in head:
        values[values == head["nodata_value"]] = np.nan
    prj = path.with_suffix(".prj")
    crs = prj.read_text(encoding="latin-1").strip() if prj.is_file() else None
    return Raster(values.reshape(ny, nx), (dx, 0.0, west, 0.0, -dy, south + ny * dy), crs or None, path.name)


def _read_numpy(path, cell):
    try:
        data = np.load(path)
        parts = {"z": data} if path.suffix.lower() == ".npy" else {k: data[k] for k in data.files}
    except Exception as error:  # numpy, zipfile and pickle raise many kinds, all mean that it is no such file
        raise GeometryError(f"terrain file {path.name}: cannot be read ({error}); is it whole?") from None
    crs = str(parts.pop("crs")) if "crs" in parts else None
    return _from_parts(parts, path, cell, crs, parts.get("nodata"))


def _read_hdf5(path, cell):
    import h5py

    with h5py.File(path) as file:
        parts = {k: file[k][()] for k in ("x", "y", "z", "elevation") if isinstance(file.get(k), h5py.Dataset)}
        known = dict(file.attrs)
        for name in ("z", "elevation"):
            if isinstance(file.get(name), h5py.Dataset):
                known.update(file[name].attrs)
    crs = known.get("crs")
    crs = crs.decode() if isinstance(crs, bytes) else crs
    return _from_parts(parts, path, cell, crs, known.get("nodata", known.get("_FillValue")))


def _from_parts(parts, path, cell, crs, nodata):
    """Return the `Raster` of arrays: z or elevation (ny, nx), and centres x (nx,), y (ny,) in either order."""
    z = next((np.asarray(parts[k]) for k in ("z", "elevation") if k in parts), None)
    if z is None or z.ndim != 2 or z.dtype.kind not in "iuf":
        found = ", ".join(f"{k} {np.shape(v)}" for k, v in parts.items()) or "nothing"
        raise GeometryError(
            f"terrain file {path.name}: it needs z or elevation, numbers (ny, nx); it holds {found}"
        )
    affordable(z.size, f"terrain file {path.name}")
    values = z.astype(np.float64)
    if nodata is not None:
        values[values == float(np.ravel(nodata)[0])] = np.nan
    if "x" not in parts or "y" not in parts:
        notes = ["row 0 of the file is taken as south"]
        return Raster(values[::-1], _placed(z.shape[0], path, cell, notes), crs, path.name, notes=notes)
    x, y = np.asarray(parts["x"], float), np.asarray(parts["y"], float)
    x, y = x[0] if x.ndim == 2 else np.ravel(x), y[:, 0] if y.ndim == 2 else np.ravel(y)
    if (len(y), len(x)) != z.shape:
        hint = ": transpose it" if (len(x), len(y)) == z.shape else ""
        raise GeometryError(
            f"terrain file {path.name}: z is {z.shape} and must be (len(y), len(x)) = {(len(y), len(x))}{hint}"
        )
    dx, dy = _even(x, "x", path), _even(y, "y", path)
    # the affine of a file whose row 0 is y[0], whichever way y and x run
    return Raster(values, (dx, 0.0, x[0] - 0.5 * dx, 0.0, dy, y[0] - 0.5 * dy), crs, path.name)


def _even(centres, name, path):
    """Return the spacing of evenly spaced centres."""
    if len(centres) < 2:
        return 1.0  # refused later, with all rasters that have one row
    step = (centres[-1] - centres[0]) / (len(centres) - 1)
    uneven = np.abs(np.diff(centres) - step).max()
    if not (step != 0 and uneven <= 1e-2 * abs(step)):
        raise GeometryError(
            f"terrain file {path.name}: {name} is not evenly spaced (steps differ by {uneven:.3g} from {step:.6g}): "
            "resample it to a regular grid"
        )
    return step
