"""The terrain's surface as VTKHDF PolyData (version 2.3), to stand under the particles of a run in ParaView."""

import math

import numpy as np

from melt.output.whole import write_whole

MOST_NODES = 1_000_000  # of the surface; a finer terrain is thinned to every second, third ... node


def write_terrain(path, grid, most=MOST_NODES, scale=1.0):
    """Write the bed as quads in the local frame of the particles; return the stride between written nodes.

    Point data: ``elevation`` [m], the world's. Field data: ``origin`` (X0, Y0, datum), which added to points gives
    the world's. Cells beside nodes without elevation or behind walls are left out.

    Args:
        scale: factor on heights of points, for looks only.

    Raises:
        OutputError: a full disk, no permission.
    """
    stride = max(1, math.ceil(math.sqrt(grid.elevation.size / most)))
    z = grid.elevation[::stride, ::stride]
    hidden = (grid.blocked | grid.open)[::stride, ::stride]
    x, y = np.meshgrid(grid.x[::stride], grid.y[::stride])
    points = np.stack([x, y, scale * z], axis=-1).reshape(-1, 3).astype(np.float32)
    number = np.arange(z.size, dtype=np.int64).reshape(z.shape)
    corners = (np.s_[:-1, :-1], np.s_[:-1, 1:], np.s_[1:, 1:], np.s_[1:, :-1])  # seen from above, left round
    seen = ~np.logical_or.reduce([hidden[c] for c in corners])
    quads = np.stack([number[c][seen] for c in corners], axis=-1)
    elevation = (z + grid.datum).ravel().astype(np.float32)
    write_whole(path, _polydata(points, quads, elevation, grid, stride))
    return stride


def _polydata(points, quads, elevation, grid, stride):
    """Return the HDF5 file as bytes; it is made in memory, so that a full disk is met by one plain write."""
    import h5py

    with h5py.File("terrain", "w", driver="core", backing_store=False) as file:
        vtk = file.create_group("VTKHDF", track_order=True)
        vtk.attrs["Version"] = np.array([2, 3], np.int64)
        vtk.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", 8))
        vtk["NumberOfPoints"] = np.array([len(points)], np.int64)
        packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
        vtk.create_dataset("Points", data=points, **packed)
        for name in ("Vertices", "Lines", "Polygons", "Strips"):
            cells = quads if name == "Polygons" else np.zeros((0, 4), np.int64)
            group = vtk.create_group(name)
            group["NumberOfCells"] = np.array([len(cells)], np.int64)
            group["NumberOfConnectivityIds"] = np.array([cells.size], np.int64)
            group.create_dataset("Offsets", data=4 * np.arange(len(cells) + 1), **packed)
            whole = packed if cells.size else {}
            group.create_dataset("Connectivity", data=cells.ravel(), **whole)
        data = vtk.create_group("PointData").create_dataset("elevation", data=elevation, **packed)
        data.attrs["unit"] = "m"
        vtk["FieldData/origin"] = np.array([*grid.origin, grid.datum])
        about = file.create_group("melt")
        about.attrs.update(
            kind="terrain", crs=grid.crs or "", transform=grid.transform, unit=grid.unit, stride=stride, name=grid.name
        )
        file.flush()
        return file.id.get_file_image()
