"""Small DEMs in every format, for the tests of terrain."""

import sys

import numpy as np
import pytest

from melt.geometry.terrain import load_terrain
from melt.scene.terrain import Terrain

UTM56 = "EPSG:32756"


def terrain(folder=None, **keys):
    """Return the grid of a [terrain] with these keys."""
    return load_terrain(Terrain(**keys), folder)


def hill(ny=6, nx=8, cell=(2.0, 2.0), south_west=(0.0, 0.0)):
    """Return (z (ny, nx) row 0 south, x (nx,), y (ny,)): a plane 10 + x / 10 + y / 5 at cell centres."""
    x = south_west[0] + (np.arange(nx) + 0.5) * cell[0]
    y = south_west[1] + (np.arange(ny) + 0.5) * cell[1]
    return 10 + 0.1 * (x - south_west[0])[None, :] + 0.2 * (y - south_west[1])[:, None], x, y


def write_tif(path, z, transform, crs=UTM56, **options):
    """Write z (row 0 north) as GeoTIFF; ``transform`` is affine (a, b, c, d, e, f)."""
    rasterio = pytest.importorskip("rasterio")
    bands = z if z.ndim == 3 else z[None]
    meta = {k: options.pop(k) for k in ("scales", "offsets", "units") if k in options}
    with rasterio.open(
        path, "w", driver="GTiff", height=bands.shape[1], width=bands.shape[2], count=len(bands), dtype=z.dtype,
        crs=crs, transform=rasterio.Affine(*transform), **options,
    ) as file:  # fmt: skip
        file.write(bands)
        for key, value in meta.items():
            setattr(file, key, value)
    return str(path)


def hill_tif(path, south_west=(382000.0, 6354000.0), cell=(2.0, 2.0), z=None, **options):
    """Write `hill` (or z, row 0 south) in UTM."""
    z = hill(cell=cell, south_west=south_west)[0] if z is None else z
    transform = (cell[0], 0.0, south_west[0], 0.0, -cell[1], south_west[1] + len(z) * cell[1])
    return write_tif(path, z[::-1].astype(options.pop("dtype", "float32")), transform, **options)


def hide_rasterio(monkeypatch):
    """Make ``import rasterio`` fail, as where it is not installed."""
    for name in [n for n in sys.modules if n == "rasterio" or n.startswith("rasterio.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rasterio", None)
