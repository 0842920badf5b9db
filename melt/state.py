"""Arrays of one run: allocation from the field table, host copies. No physics."""

import numpy as np

from melt.fields import FIELDS

REAL = {"single": np.float32, "mixed": np.float32, "double": np.float64}
POSITION = {"single": np.float32, "mixed": np.float64, "double": np.float64}


def dtype_of(field, precision):
    """Return the dtype of a `melt.fields.Field` under a precision policy."""
    if field.kind == "int":
        return np.int32
    if field.kind == "double":
        return np.float64
    return (POSITION if field.kind == "position" else REAL)[precision]


def shape_of(field, sizes):
    """Return the shape of a field, given the size of each extent."""
    return tuple(int(e) if e.isdigit() else sizes[e] for e in field.shape)


def bytes_of(field, sizes, precision):
    """Return the memory of a field in bytes."""
    return int(np.prod(shape_of(field, sizes), dtype=np.int64)) * np.dtype(dtype_of(field, precision)).itemsize


class State:
    """The arrays of a run by name, on one backend.

    ``sizes`` maps extents to numbers; fields that the plan did not list are absent and
    reach stages as arrays of length 0.
    """

    def __init__(self, backend, precision, sizes, names):
        self.backend, self.precision, self.sizes = backend, precision, dict(sizes)
        self.arrays = {}
        self._absent = {}
        self.version = 0  # changes whenever a name is bound to another array
        for name in names:
            self.allocate(name)

    def allocate(self, name):
        """Bind ``name`` to a new array of zeros."""
        field = FIELDS[name]
        zeros = np.zeros(shape_of(field, self.sizes), dtype_of(field, self.precision))
        self.arrays[name] = self.backend.upload(zeros)
        self.version += 1

    def __contains__(self, name):
        return name in self.arrays

    def get(self, name):
        """Return the array called ``name``, or one of length 0 if the scene has none."""
        if name in self.arrays:
            return self.arrays[name]
        if name not in self._absent:
            field = FIELDS[name]
            shape = tuple(int(e) if e.isdigit() else 0 for e in field.shape)
            self._absent[name] = self.backend.upload(np.zeros(shape, dtype_of(field, self.precision)))
        return self._absent[name]

    def set(self, name, values):
        """Copy host values into the field ``name``."""
        field = FIELDS[name]
        values = np.ascontiguousarray(values, dtype=dtype_of(field, self.precision))
        expected = shape_of(field, self.sizes)
        if values.shape != expected:
            raise ValueError(f"field {name}: got shape {values.shape}, expected {expected}")
        self.arrays[name] = self.backend.upload(values)
        self.version += 1

    def read(self, name):
        """Return a host copy of the field ``name``."""
        return self.backend.download(self.get(name))

    def swap(self, first, second):
        """Exchange the arrays of two fields of equal shape and dtype."""
        a = self.arrays
        a[first], a[second] = a[second], a[first]
        self.version += 1

    def resize(self, extent, size):
        """Give every array with this extent the new size; their contents are lost."""
        self.sizes[extent] = size
        for name in self.arrays:
            if extent in FIELDS[name].shape:
                self.allocate(name)

    @property
    def nbytes(self):
        """Memory of all arrays in bytes."""
        return sum(int(np.prod(a.shape, dtype=np.int64)) * a.dtype.itemsize for a in self.arrays.values())
