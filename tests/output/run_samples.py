import numpy as np
import pytest


def particles(seed, n, real=np.float32):
    """Return the fields of a small frame; different for every seed."""
    rng = np.random.default_rng(seed)
    return {
        "id": np.arange(n, dtype=np.int32),
        "position": rng.random((n, 3)).astype(real),
        "velocity": rng.normal(size=(n, 3)).astype(np.float32),
        "phase": rng.integers(0, 3, n).astype(np.int32),
        "temperature": rng.uniform(-10, 90, n),
    }


def same(a, b):
    """Return whether two frames hold the same fields, values and types."""
    return a.keys() == b.keys() and all(
        a[k].dtype == b[k].dtype and a[k].shape == b[k].shape and np.array_equal(a[k], b[k]) for k in a
    )


def vtk_frames(path):
    """Return what VTK's own reader finds: a list of (time, frame).

    VTK takes a file of one step as a still picture: its time is None. A run without frames
    is a still picture without the cell that every frame has: no frame.
    """
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    errors = []
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("reader"))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: errors.append("pipeline"))
    reader.UpdateInformation()
    assert not errors, errors
    info, key = reader.GetOutputInformation(0), vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    frames = []
    for time in [info.Get(key, k) for k in range(info.Length(key))] or [None]:
        reader.Update() if time is None else reader.UpdateTimeStep(time)
        assert not errors, errors
        data = reader.GetOutput()
        if time is None and data.GetNumberOfCells() == 0:
            return []
        n = data.GetNumberOfPoints()
        assert data.GetNumberOfVerts() == 1 and data.GetNumberOfCells() == 1
        assert data.GetCell(0).GetNumberOfPoints() == n
        frame = {"position": vtk_to_numpy(data.GetPoints().GetData()) if n else np.zeros((0, 3), np.float32)}
        point = data.GetPointData()
        for i in range(point.GetNumberOfArrays() if n else 0):
            frame[point.GetArrayName(i)] = vtk_to_numpy(point.GetArray(i)).copy()
        frames.append((time, frame))
    return frames


def drop_and_cube(path, frames=2, fields=("temperature", "velocity", "material"), phase=True):
    """Write a run of a hot drop (radius 6 dx, left) and a cube of ice (6 dx, right); return its path."""
    from melt.output.run_file import RunWriter

    dx = 0.02
    axis = np.arange(-8, 8) + 0.5
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    drop, cube = grid[(grid**2).sum(axis=1) < 36], grid[np.abs(grid).max(axis=1) < 3]
    x = np.concatenate([drop, cube + (18, 0, 0)]) * dx
    kind = np.repeat([0, 1], [len(drop), len(cube)]).astype(np.int32)
    scene = "[scene]\nname = 'drop'\n[domain]\n"
    scene += f"lower = [-0.2, -0.2, -0.2]\nupper = [0.5, 0.2, 0.3]\nspacing = {dx}\n"
    with RunWriter(path, scene, {"melt": "0"}, overwrite=True) as writer:
        for k in range(frames):
            frame = {"position": (x + (0, 0, 0.01 * k)).astype(np.float32)}
            frame |= {"phase": kind} if phase else {}
            extra = {
                "temperature": np.where(kind == 0, 80.0, -10.0).astype(np.float32),
                "velocity": np.tile(x, 1).astype(np.float32),
                "material": kind.copy(),
            }
            frame |= {name: extra[name] for name in fields}
            writer.append(
                0.1 * k, frame, {"kinetic_energy": 1.5 * k, "ms/density": 2.0, "solid_particles": 211}
            )
    return path
