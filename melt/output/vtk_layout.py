"""The VTKHDF part of a run file: temporal PolyData of vertices, version 2.3."""

import math

import numpy as np

from melt.fields import FIELDS
from melt.output.hdf5 import Chunked, Small

_EMPTY_CELLS = ("Lines", "Polygons", "Strips")


def lay_out_nothing(vtk, file):
    """Make a still picture without points, which VTK opens, until there is a first frame."""
    vtk.children = {"Points": Small(np.float32, (3,)), "NumberOfPoints": Small(np.int64)}
    vtk["NumberOfPoints"].append(file, 0)
    for cells in ("Vertices", *_EMPTY_CELLS):
        for name in ("NumberOfCells", "NumberOfConnectivityIds", "Connectivity", "Offsets"):
            dataset = vtk.group(cells).children[name] = Small(np.int64)
            dataset.append(file, [] if name == "Connectivity" else 0)


def lay_out(vtk, particles):
    """Make the datasets of the first frame."""
    n = len(particles["position"])
    # one chunk holds about a frame: a frame is read in one go, and small runs waste little
    chunk_rows = 1 << min(max(math.ceil(math.log2(max(n, 1))), 10), 16)

    def count(**attrs):
        return Small(np.int64, **attrs)

    def field(name):
        array, known = particles[name], FIELDS.get(name)
        attrs = {"unit": known.unit, "meaning": known.meaning} if known else {"unit": "1"}
        return Chunked(array.dtype, array.shape[1:], chunk_rows, **attrs)

    vtk.children.update(Points=field("position"), NumberOfPoints=count())
    for cells in ("Vertices", *_EMPTY_CELLS):
        vtk.group(cells).children.update(
            NumberOfCells=count(), NumberOfConnectivityIds=count(), Connectivity=count(), Offsets=count()
        )
    names = [name for name in particles if name != "position"]
    vtk.group("PointData").children.update({name: field(name) for name in names})
    steps = vtk.group("Steps")
    steps.children.update(
        Values=Small(np.float64, unit="s"),
        PartOffsets=count(),
        NumberOfParts=count(),
        PointOffsets=count(),
        CellOffsets=Small(np.int64, (4,)),
        ConnectivityIdOffsets=Small(np.int64, (4,)),
    )
    steps.group("PointDataOffsets").children.update({name: count() for name in names})


def append_frame(vtk, file, k, time, particles):
    """Append frame ``k`` behind the others."""
    start, n = vtk["Points"].rows, len(particles["position"])
    vtk["Points"].append(file, particles["position"])
    vtk["NumberOfPoints"].append(file, n)
    vertices = vtk["Vertices"]
    vertices["NumberOfCells"].append(file, 1)
    vertices["NumberOfConnectivityIds"].append(file, n)
    vertices["Offsets"].append(file, [0, n])
    # every frame's cell lists its own points 0..n-1: all frames share the longest list
    vertices["Connectivity"].append(file, np.arange(vertices["Connectivity"].rows, n))
    for cells in _EMPTY_CELLS:
        for name in ("NumberOfCells", "NumberOfConnectivityIds", "Offsets"):
            vtk[cells][name].append(file, 0)
    steps = vtk["Steps"]
    for name, value in (
        ("Values", time),
        ("PartOffsets", k),
        ("NumberOfParts", 1),
        ("PointOffsets", start),
    ):
        steps[name].append(file, value)
    steps["CellOffsets"].append(file, [k, 0, 0, 0])
    steps["ConnectivityIdOffsets"].append(file, [0, 0, 0, 0])
    for name, dataset in vtk["PointData"].children.items():
        dataset.append(file, particles[name])
        steps["PointDataOffsets"][name].append(file, start)


def rows_until(root, frames, readings=0):
    """Return a function (path, dataset) -> rows that ``frames`` frames have in it, ``readings`` those of the gauges."""
    particles = root["VTKHDF/Steps"].start_rows[frames]
    longest = root["VTKHDF/Steps"].longest[frames]

    def rows(path, dataset):
        parts = path.split("/")
        if parts[:2] == ["melt", "scene"]:
            return 1
        if parts[:2] == ["melt", "gauges"]:
            return readings
        if parts[:2] == ["melt", "maps"]:
            return dataset.rows
        if parts[-1] == "Points" or parts[1] == "PointData":
            return particles
        if parts[1] == "Vertices" and parts[2] in ("Connectivity", "Offsets"):
            return longest if parts[2] == "Connectivity" else 2 * frames
        return frames

    return rows
