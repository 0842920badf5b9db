"""The HDF5 file of a sweep: one group per map, its cells as columns; whole under its name, ``.part`` until then.

Every finished cell is written to a temporary name that is then renamed, so a kill at any moment leaves a whole ``.part``.
"""

import pathlib
from typing import NamedTuple

import h5py
import numpy as np

from melt.errors import MeltError
from melt.output.checkpoint import fingerprint
from melt.output.errors import check_hdf5, read_error
from melt.output.whole import whole


def picture(out):
    """Return where the plot of a sweep is: beside its file."""
    return pathlib.Path(out).with_suffix(".png")


class Cell(NamedTuple):
    """One run: the place in its row, its grade, and why."""

    row: int
    k: int  # quarters of an octave from the predicted bound
    value: float  # of the second knob
    x: float  # of the first knob: mean step [s], or the value
    grade: str
    reason: str
    step: int  # at which it was graded so
    steps: int  # taken
    bound: str  # that governed at the start
    worst: float  # largest figure of an alarm over its limit


class Kept:
    """Cells of a sweep on disk (nowhere for ``out`` None)."""

    def __init__(self, out, scene, rows, steps, overwrite=False):
        """Take up what an earlier, killed sweep of the same scene, rows and steps has left.

        Raises:
            MeltError: ``out`` is there, or what was left is of another sweep, and ``overwrite`` is not given.
        """
        self.out = None if out is None else pathlib.Path(out)
        self.part = None if out is None else self.out.with_name(self.out.name + ".part")
        self.attrs = {"scene": scene.scene.name, "rows": rows or 0, "steps": steps or 0}
        self.attrs["mark"] = fingerprint(f"{rows} {steps} {scene.to_toml()}")
        self.groups = {}  # map -> (attributes, cells)
        if out is None:
            return
        check_hdf5(self.out, "an atlas")
        for there in (self.out, picture(self.out)):
            if there.exists() and not overwrite:
                raise MeltError(f"{there} exists: name another file with --output, or give --overwrite")
        if self.part.exists():
            attrs, groups = read(self.part)
            if attrs.get("mark") == self.attrs["mark"]:
                self.groups = groups
            elif not overwrite:
                raise MeltError(
                    f"{self.part} is left from a sweep of another scene, or with other --set, --cells or --steps: "
                    "repeat that one to resume it, or give --overwrite"
                )
        self._write()  # a path that cannot be written must not cost a sweep

    def cells(self, m):
        """Return the list of cells of a map that are there; `save` keeps what is added to it."""
        also = [(words, [(v, f(v)) for v in m.along.values(self.attrs["rows"] or m.rows)]) for words, f in m.also]
        attrs = {"across": m.words, "across_unit": m.unit, "along": m.along.words, "along_unit": m.along.unit, "predicted": m.predicted}
        attrs |= {"bound": m.bound if m.across is not None else np.nan, "octaves": m.octaves, "limits": _limits(m)}
        _, cells = self.groups.get(m.name, ({}, []))
        self.groups[m.name] = ({**attrs, **{f"also {words}": np.array(points) for words, points in also}}, cells)
        return cells

    def save(self, m, cells):
        """Write all cells so far."""
        if self.out is not None:
            self._write()

    def finish(self, plan):
        """Write the file under its name; runs of other maps, of an earlier sweep, stay in the ``.part``."""
        if self.out is None:
            return
        done = {m.name: self.groups.pop(m.name) for m in plan}
        self._write(self.out, done)
        self.groups = {name: group for name, group in self.groups.items() if group[1]}
        if self.groups:
            self._write()
        else:
            self.part.unlink(missing_ok=True)

    def close(self, say):
        """Say what is left of a sweep that has not come to its end."""
        if self.part is not None and self.part.exists():
            runs = sum(len(cells) for _, cells in self.groups.values())
            say(f"not finished: {runs} runs are kept in {self.part}; the same command goes on from there")

    def _write(self, path=None, groups=None):
        path, groups = path or self.part, self.groups if groups is None else groups
        with whole(path, "write atlas") as temporary, h5py.File(temporary, "w") as file:
            file.attrs.update(self.attrs)
            for name, (attrs, cells) in groups.items():
                group = file.create_group(name)
                group.attrs.update(attrs)
                for field in Cell._fields:
                    values = [getattr(cell, field) for cell in cells]
                    group[field] = values if values else np.zeros(0)


def cells_of(group):
    """Return the list of `Cell` of a map's group."""
    columns = [group[field].asstr()[()] if group[field].dtype.kind == "O" else group[field][()] for field in Cell._fields]
    return [Cell(*(v.item() if isinstance(v, np.generic) else v for v in row)) for row in zip(*columns)]


def _limits(m):
    return "; ".join(f"{a.words}: noisy above {a.noisy:g}, failed above {a.failed:g}" for a in m.alarms)


def read(path):
    """Return (attributes, {map: (attributes, list of `Cell`)}) of a file.

    Raises:
        RunFileError: it is no atlas, or damaged.
    """
    try:
        with h5py.File(path) as file:
            return dict(file.attrs), {name: (dict(group.attrs), cells_of(group)) for name, group in file.items()}
    except (OSError, KeyError) as error:
        raise read_error("read atlas", path, error) from error
