"""Reading run files: of finished, running and killed runs."""

import pathlib

import h5py
import numpy as np

from melt.output.errors import RunFileError, read_error
from melt.output.hdf5 import Chunked, Group, Small
from melt.output.hdf5_messages import UNDEFINED


def open_run(path):
    """Return the `Run` in a file.

    Raises:
        RunFileError: there is no such file, it is cut short, or it is not a run file of melt.
    """
    return Run(path)


def _text(value):
    return value.decode() if isinstance(value, bytes) else value.item() if hasattr(value, "item") else value


def _value(value):
    return value if isinstance(value, np.ndarray) else _text(value)


class Run:
    """A run file: ``times`` [s], ``series``, ``scene_text``, ``provenance``, ``end``, frames by number."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self._file = _open(self.path)
        try:
            self._read_tables()
        except (KeyError, OSError, ValueError, TypeError, AttributeError, UnicodeDecodeError) as error:
            self._file.close()
            raise RunFileError(
                f"{path} looks like a run file of melt, but its tables cannot be read ({error}): it was changed "
                "or damaged; copy it again, or start the run afresh."
            ) from error

    def _read_tables(self):
        vtk = self._file["VTKHDF"]
        steps = vtk.get("Steps")
        self.times = steps["Values"][:] if steps else np.zeros(0)
        self._start = steps["PointOffsets"][:] if steps else np.zeros(0, np.int64)
        self._count = vtk["NumberOfPoints"][:] if steps else np.zeros(0, np.int64)
        if not len(self.times) == len(self._start) == len(self._count):
            raise ValueError(
                f"{len(self.times)} times, {len(self._start)} offsets, {len(self._count)} counts"
            )
        data = vtk.get("PointData", {})
        self.units = {name: _text(data[name].attrs.get("unit", b"1")) for name in data}
        if steps:
            self.units["position"] = "m"
        melt = self._file.get("melt", {})
        self.scene_text = melt["scene"][()].decode().strip("\0") if "scene" in melt else ""
        self.provenance = {}
        if "provenance" in melt:
            self.provenance = {name: _text(value) for name, value in melt["provenance"].attrs.items()}
        self.end = {name: _value(v) for name, v in melt["end"].attrs.items()} if "end" in melt else {}
        self.series, self.series_units = {}, {}
        if "series" in melt:
            melt["series"].visititems(self._read_series)
        self.maps = {name: item[:] for name, item in melt.get("maps", {}).items()}
        self.map_units = {name: _text(item.attrs.get("unit", b"m")) for name, item in melt.get("maps", {}).items()}
        self.map_facts = {name: _value(v) for name, v in melt["maps"].attrs.items()} if "maps" in melt else {}
        self.gauges = {name: item[:] for name, item in melt.get("gauges", {}).items()}

    def _read_series(self, name, item):
        if isinstance(item, h5py.Dataset):
            self.series[name] = item[:]
            self.series_units[name] = _text(item.attrs.get("unit", b"1"))

    def __len__(self):
        return len(self.times)

    @property
    def fields(self):
        """Names of the particle fields."""
        return list(self.units)

    @property
    def counts(self):
        """Particles of each frame."""
        return self._count

    def frame(self, k, fields=None):
        """Return frame ``k`` (negative from the end): field name -> array (n,) or (n, 3).

        Raises:
            RunFileError: there is no such frame or field.
        """
        if len(self) == 0:
            raise RunFileError(f"{self.path} has no frame yet.")
        if not -len(self) <= k < len(self):
            raise RunFileError(
                f"{self.path} has {len(self)} frames; frame {k} is none of them (first 0, last -1)."
            )
        k %= len(self)
        rows = slice(self._start[k], self._start[k] + self._count[k])
        frame = {}
        for name in self.fields if fields is None else fields:
            if name not in self.units:
                raise RunFileError(
                    f"{self.path} has no field '{name}'; it has {', '.join(sorted(self.units))}."
                )
            source = "Points" if name == "position" else f"PointData/{name}"
            try:
                frame[name] = self._file["VTKHDF"][source][rows]
            except OSError as error:
                raise RunFileError(f"frame {k} of {self.path} cannot be read: {error}.") from error
        return frame

    def close(self):
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def _open(path):
    try:
        with open(path, "rb") as head:
            start = head.read(48)
            size = head.seek(0, 2)
    except OSError as error:
        raise read_error("open", path, error) from error
    if start[:8] != b"\x89HDF\r\n\x1a\n":
        raise RunFileError(
            f"{path} is not an HDF5 file, so it is no run file of melt; `melt run` writes NAME.vtkhdf."
        )
    expected = int.from_bytes(start[28:36], "little") if len(start) == 48 and start[8] in (2, 3) else 0
    if len(start) < 48 or size < expected:
        raise RunFileError(
            f"{path} is cut short: {size} bytes of {expected or 'more'}. melt never leaves such a file, "
            "so a copy or download broke off; copy it again."
        )
    try:
        # a reader must not disturb, nor be refused by, a run that is still writing
        file = h5py.File(path, "r", locking=False)
    except OSError as error:
        raise RunFileError(f"{path} cannot be read as HDF5: {error}.") from error
    try:
        kind = file["VTKHDF"].attrs["Type"]
        known = kind in (b"PolyData", "PolyData") and "melt/scene" in file
        if known and "Steps" in file["VTKHDF"]:
            file["VTKHDF/Steps/Values"], file["VTKHDF/Points"], file["VTKHDF/NumberOfPoints"]
    except (KeyError, OSError):
        known = False
    if not known:
        file.close()
        raise RunFileError(
            f"{path} is HDF5 but no run file of melt (it lacks /VTKHDF of particles and /melt)."
        )
    return file


# --- for RunWriter.resume -------------------------------------------------------------------


def load_tree(path):
    """Return (tree of `melt.output.hdf5` objects, frames, end of the file) to continue a run file."""
    with _open(path) as file:
        try:
            root = _group(file)
            frames = int(file["VTKHDF/Steps"].attrs["NSteps"]) if "VTKHDF/Steps" in file else 0
            if frames:
                starts = file["VTKHDF/Steps/PointOffsets"][:]
                counts = file["VTKHDF/NumberOfPoints"][:]
                steps = root["VTKHDF/Steps"]
                steps.start_rows = [*map(int, starts), int(starts[-1] + counts[-1])]
                steps.longest = [0, *map(int, np.maximum.accumulate(counts))]
        except (KeyError, OSError, RuntimeError) as error:
            raise RunFileError(f"{path} cannot be continued: {error}.") from error
    with open(path, "rb") as head:
        end = int.from_bytes(head.read(36)[28:], "little")
    return root, frames, end


def _attributes(item):
    values = {}
    for name, value in item.attrs.items():
        ascii_text = name == "Type"  # VTK wants ASCII here; all other text is UTF-8
        values[name] = value.decode() if isinstance(value, bytes) and not ascii_text else value
    return values


def _group(source):
    group = Group(**_attributes(source))
    for name, item in source.items():
        group.children[name] = _group(item) if isinstance(item, h5py.Group) else _dataset(item)
    return group


def _dataset(source):
    tail = source.shape[1:] if source.shape else None
    if source.chunks is None:
        dataset = Small(source.dtype, tail, **_attributes(source))
        dataset.rows = source.shape[0] if source.shape else 1
        dataset.capacity = dataset.rows
        dataset.address = source.id.get_offset() or UNDEFINED
        return dataset
    dataset = Chunked(source.dtype, tail, source.chunks[0], **_attributes(source))
    dataset.rows = source.shape[0]
    dataset.chunks = [0] * source.id.get_num_chunks()

    def note(chunk):
        dataset.chunks[chunk.chunk_offset[0] // source.chunks[0]] = chunk.byte_offset

    source.id.chunk_iter(note)
    return dataset
