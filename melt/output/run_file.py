"""Run files: one VTKHDF file per run, appended frame by frame, whole after every frame.

Layout (VTKHDF 2.3, temporal PolyData; https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/)::

    /VTKHDF/Points, PointData/*        rows of all frames behind each other, (n, 3) or (n,)
    /VTKHDF/Vertices/*                 one poly-vertex cell per frame
    /VTKHDF/Lines, Polygons, Strips    none
    /VTKHDF/Steps/*                    times and where each frame begins
    /melt/scene, provenance, series/*  scene text, attributes, one number per frame each
    /melt/gauges/*                     readings between frames: time (k,), others (k, gauges)
    /melt/maps/*                       maps of the whole run, written at its end
    /melt/end                          attributes: how the run ended (running, complete, alarm, error, interrupted), when, why

`melt.output.hdf5` says why a killed run leaves a file with all completed frames.
"""

import errno
import math
import os
import pathlib
import stat

import numpy as np

from melt.fields import FIELDS
from melt.output import hdf5, run_tables, vtk_layout
from melt.output.errors import OutputError, RunFileError, output_error
from melt.output.hdf5 import Group, Small


def followed(path):
    """Return the path of a file, that of its target for a symbolic link."""
    return pathlib.Path(os.path.realpath(path) if os.path.islink(path) else path)


def _check_replaceable(path):
    """Raise `OutputError` unless what is at ``path`` is a run file, or an empty file."""
    from melt.output.run_reader import open_run

    try:
        found = os.stat(path)
        if stat.S_ISDIR(found.st_mode):
            raise IsADirectoryError(errno.EISDIR, "")
    except OSError as error:
        raise output_error("create", path, error) from error
    what = "another kind of file" if stat.S_ISREG(found.st_mode) else "a device, a pipe or a socket"
    if stat.S_ISREG(found.st_mode):  # to open another kind may wait, or do something
        if found.st_size == 0:
            return
        try:
            return open_run(path).close()
        except RunFileError:
            pass
    raise OutputError(
        f"the output {path} was left as it is: it is {what} and no whole run file of melt, and --overwrite replaces "
        "only those. Name another file with --output, or remove it yourself."
    )


class RunWriter:
    """Writer of one run file.

    Args:
        path: the file, by custom ``NAME.vtkhdf``.
        scene_text: the scene as run (TOML).
        provenance: name -> str, int or float (see `melt.output.provenance`).
        overwrite: replace an existing run file, which stays as it is until the first frame of this one is written.
        sync: wait for the disk at every frame, so that frames survive a power cut too.

    Raises:
        OutputError: the file exists, is not one that may be replaced, or cannot be written.
    """

    def __init__(self, path, scene_text, provenance, overwrite=False, sync=True):
        if not overwrite and os.path.lexists(path):  # never raises, whatever the name
            raise OutputError(
                f"the output {path} exists already and was left as it is: name another file with "
                "--output, replace it with --overwrite, or continue it with `melt resume`."
            )
        self.path = followed(path)
        older = os.path.lexists(self.path)
        if older:
            _check_replaceable(self.path)
        self._broken = None
        self.frames = 0
        self._root = Group()
        self._root.group("VTKHDF").attrs = {"Version": np.array([2, 3], np.int64), "Type": b"PolyData"}
        melt = self._root.group("melt")
        self._paper = 'law = "paper"' in scene_text
        text = scene_text.encode() or b"\n"
        melt.children["scene"] = Small(f"S{len(text)}", None)
        melt.group("provenance").attrs = dict(provenance)
        melt.group("series")
        melt.group("end").attrs = {"how": "running"}
        # of its own: another run may be about to replace the same file
        self._beside = temporary = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
        try:
            self._file = hdf5.File(temporary, os.O_RDWR | os.O_CREAT | os.O_TRUNC, sync)
        except OSError as error:
            raise output_error("create", self.path, error) from error
        try:
            melt["scene"].append(self._file, np.array(text))
            vtk_layout.lay_out_nothing(self._root["VTKHDF"], self._file)
            self._file.commit(self._root)
            if not older:
                self._take_place()
        except OSError as error:
            self._file.close()
            temporary.unlink(missing_ok=True)
            raise output_error("create", self.path, error) from error

    @classmethod
    def resume(cls, path, frames=None, sync=True):
        """Open an existing run file, cut it back to its first ``frames`` frames, and continue it.

        Raises:
            RunFileError: not a whole run file of melt, or fewer frames than asked for.
            OutputError: it cannot be written.
        """
        from melt.output.run_reader import load_tree

        self = cls.__new__(cls)
        self.path, self._broken, self._beside, self._paper = followed(path), None, None, False  # series have their units
        self._root, self.frames, end = load_tree(self.path)
        try:
            self._file = hdf5.File(self.path, os.O_RDWR, sync)
        except OSError as error:
            raise output_error("continue", self.path, error) from error
        self._file.end = self._file.committed_end = end
        try:
            self._cut(self.frames if frames is None else frames)
        except OSError as error:
            raise self._fail("continue", error) from error
        return self

    def append(self, time, particles, series=None, readings=None):
        """Write one frame and make it part of the file, at once or not at all.

        Args:
            time: simulated time [s], later than the last frame.
            particles: field name -> array (n,) or (n, 3); ``position`` among them; n may be 0 and
                may change, names and dtypes may not.
            series: name -> number; ``a/b`` goes to a group a; what is missing becomes NaN or 0.
            readings: name -> array (k, ...) of what was read since the last frame, ``time`` among them.

        Raises:
            OutputError: the frame could not be written; the file keeps all earlier frames.
        """
        if self._broken:
            raise OutputError(self._broken)
        particles = {name: np.asarray(array) for name, array in particles.items()}
        self._check(time, particles)
        series = {"time": float(time), **(series or {})}
        if readings:
            series["gauge_readings"] = run_tables.readings_of(self._root) + len(readings["time"])
        try:
            if self.frames == 0:
                vtk_layout.lay_out(self._root["VTKHDF"], particles)
            vtk_layout.append_frame(self._root["VTKHDF"], self._file, self.frames, float(time), particles)
            run_tables.append_series(self._root, self._file, self.frames, series, self._paper)
            run_tables.append_readings(self._root, self._file, readings or {})
            self._root["VTKHDF/Steps"].attrs["NSteps"] = np.int64(self.frames + 1)
            self._file.commit(self._root)
            if self._beside:
                self._take_place()
        except OSError as error:
            raise self._fail(f"write frame {self.frames} (t = {time:g} s) to", error) from error
        self.frames += 1

    def tell(self, name, text):
        """Add a fact to the provenance; the next frame brings it into the file."""
        self._root["melt/provenance"].attrs[name] = text

    def store(self, arrays, attributes, units=None):
        """Write arrays of the whole run to ``/melt/maps``, in place of those of an earlier end.

        Args:
            arrays: name -> array (ny, nx). attributes: of the group, name -> str, number or list of numbers.
            units: name -> unit, m unless given.

        Raises:
            OutputError: they could not be written; the file keeps its frames.
        """
        if self._broken:
            raise OutputError(self._broken)
        try:
            run_tables.put_maps(self._root, self._file, arrays, attributes, units or {})
            self._file.commit(self._root)
        except OSError as error:
            raise self._fail("write the maps of", error) from error

    def end(self, how, **facts):
        """Record how the run ended (see `melt.ending`); a file that is continued is ``running`` again.

        Raises:
            OutputError: it could not be written; the file keeps its frames.
        """
        if self._broken:
            raise OutputError(self._broken)
        self._root["melt/end"].attrs = {"how": how, **facts}
        try:
            self._file.commit(self._root)
        except OSError as error:
            raise self._fail("write the end of", error) from error

    def close(self, keep_empty=True):
        """Close the file; it is whole before and after. An older one that no frame has replaced stays."""
        self._file.close()
        if self._beside:
            self._beside.unlink(missing_ok=True)
        elif not self.frames and not keep_empty:
            self.path.unlink(missing_ok=True)
        self._broken = self._broken or f"the run file {self.path} is closed."

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _take_place(self):
        """Give the file its name, in place of an older one."""
        os.replace(self._beside, self.path)
        self._beside = None

    # --- the parts of a frame ---

    def _check(self, time, particles):
        if "position" not in particles:
            raise OutputError(
                f"frame {self.frames} of {self.path} has no field 'position': pass it as (n, 3)."
            )
        n = len(particles["position"])
        for name, array in particles.items():
            components = 3 if name == "position" or name in FIELDS and FIELDS[name].shape[0] == "3" else None
            allowed = [(n, 3)] if components else [(n,), (n, 3)]
            if array.shape not in allowed or array.dtype.kind not in "fiu":
                raise OutputError(
                    f"field '{name}' of frame {self.frames} has shape {array.shape} and type {array.dtype}; "
                    f"allowed are numbers of shape {' or '.join(map(str, allowed))}."
                )
        if not math.isfinite(time) or (self.frames and time <= self._last_time):
            raise OutputError(
                f"frame {self.frames} of {self.path} has time {time}; it must be later than the last frame."
            )
        if self.frames:
            data = self._root["VTKHDF/PointData"].children
            if set(data) | {"position"} != set(particles):
                raise OutputError(
                    f"frame {self.frames} of {self.path} has the fields {sorted(particles)}; "
                    f"a run file keeps the fields of its first frame: {sorted([*data, 'position'])}."
                )
        self._last_time = time

    # --- failure and resumption ---

    def _fail(self, what, error):
        self._broken = str(output_error(what, self.path, error))
        kept = "The earlier file is untouched." if self._beside else f"The file holds all {self.frames} earlier frames."
        self._broken += f" {kept}"
        try:
            self._file.discard()
        except OSError:
            pass  # what lies behind the last commit is invisible to readers
        return OutputError(self._broken)

    def _cut(self, frames):
        """Cut back to ``frames`` frames; at every instant the file holds the old or the new state."""
        root, file, old = self._root, self._file, self.frames
        if not 0 <= frames <= old:
            raise RunFileError(f"{self.path} has {old} frames; it cannot be continued from frame {frames}.")
        if frames < old:
            rows = vtk_layout.rows_until(root, frames, run_tables.readings_until(root, file, frames))
            if frames:
                for path, item in root.walk():
                    if not isinstance(item, Group):
                        item.cut(rows(path, item))
                root["VTKHDF/Steps"].attrs["NSteps"] = np.int64(frames)
            else:
                vtk_layout.lay_out_nothing(self._root["VTKHDF"], self._file)
                root["melt/series"].children.clear()
        self.frames = frames
        root.group("melt/end").attrs = {"how": "running"}
        self._last_time = -math.inf
        if frames:
            values = root["VTKHDF/Steps/Values"]
            self._last_time = np.frombuffer(file.read(8, values.address + 8 * (frames - 1)))[0]
        old_end = file.end
        file.commit(root)
        # the new metadata lie behind the dropped frames: move them down and give the space back
        datasets = [item for _, item in root.walk() if not isinstance(item, Group)]
        bottom = max(item.end() for item in datasets)
        bottom += -bottom % 8
        if bottom + (file.end - old_end) <= old_end:
            for item in datasets:
                item.full = [[]]
            file.end, file.areas, file.commits = bottom, [], 0
            file.commit(root)
            file.discard()
