"""Append-only writer of HDF5 files that are whole at every instant.

The HDF5 library updates its metadata in place, so a killed writer leaves a file that no
reader opens (and SWMR mode leaves a flag that plain readers refuse). This writer never
overwrites anything that the file on disk refers to:

1. new rows go behind the rows that the committed metadata shows;
2. all object headers, and the growing edge of each chunk index, go to a fresh metadata area;
3. the 48 bytes of the superblock, inside one disk sector, are switched to the new root.

A kill, a full disk or a power cut before 3 leaves the previous commit untouched. The areas
of step 2 are used in rotation (`AREAS`), so that metadata do not pile up while a program that
has the file open still finds what it opened some commits ago.

Only what run files need is written: superblock 2, object headers 2, compact groups and
attributes, contiguous datasets for small ones and chunked ones (layout 3, version 1 B-tree)
for particle fields: all readable since HDF5 1.8. Datatypes are encoded by the library.
Format: https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html
"""

import os
import struct

import numpy as np

from melt.output.hdf5_messages import (
    UNDEFINED,
    Area,
    attribute,
    dataspace,
    datatype,
    link,
    object_header,
    superblock,
)

AREAS = 8
FANOUT = 64  # children of a B-tree node: 2K with the library's default K = 32


# --- objects -----------------------------------------------------------------------------


class Group:
    """A group: children by name, attributes."""

    def __init__(self, **attrs):
        self.attrs = attrs
        self.children = {}

    def __getitem__(self, path):
        node = self
        for name in path.split("/"):
            node = node.children[name]
        return node

    def group(self, path):
        """Return the group at ``path``, made where it is missing."""
        node = self
        for name in path.split("/"):
            node = node.children.setdefault(name, Group())
        return node

    def walk(self, prefix=""):
        """Yield (path, object) of everything below."""
        for name, child in self.children.items():
            yield prefix + name, child
            if isinstance(child, Group):
                yield from child.walk(f"{prefix}{name}/")

    def place(self, area):
        links = [link(name, child.place(area)) for name, child in self.children.items()]
        fixed = [(0x02, struct.pack("<BBQQ", 0, 0, UNDEFINED, UNDEFINED)), (0x0A, b"\0\0")]
        return area.add(
            object_header(fixed + [attribute(*a) for a in self.attrs.items()] + links, area.final)
        )


class Dataset:
    """Rows of one dtype; ``tail`` is the shape of a row, ``None`` for a scalar dataset."""

    def __init__(self, dtype, tail=(), **attrs):
        self.dtype, self.tail, self.attrs, self.rows = np.dtype(dtype), tail, attrs, 0
        self.row_bytes = self.dtype.itemsize * int(np.prod(tail or ()))

    @property
    def shape(self):
        return () if self.tail is None else (self.rows, *self.tail)

    def rows_of(self, values):
        values = np.ascontiguousarray(values, dtype=self.dtype)
        return values.reshape(-1, *(self.tail or ()))

    def place(self, area):
        messages = [
            (0x01, dataspace(self.shape)),
            (0x03, datatype(self.dtype)),
            (0x05, bytes((3, self.fill))),
            (0x08, self.layout(area)),
        ]
        return area.add(object_header(messages + [attribute(*a) for a in self.attrs.items()], area.final))


class Small(Dataset):
    """Contiguous; moves to a place twice as large when it is full."""

    fill = 0x0A  # allocated late, filled if set

    def __init__(self, dtype, tail=(), **attrs):
        super().__init__(dtype, tail, **attrs)
        self.address, self.capacity = UNDEFINED, 0

    def append(self, file, values):
        values = self.rows_of(values)
        if len(values) == 0:
            return
        rows = self.rows + len(values)
        if rows > self.capacity:
            grown = 1 if self.tail is None else max(2 * self.capacity, rows, 64)
            address = file.allocate(grown * self.row_bytes)
            if self.rows:
                file.write(file.read(self.rows * self.row_bytes, self.address), address)
            self.address, self.capacity = address, grown
        file.write(values.tobytes(), self.address + self.rows * self.row_bytes)
        self.rows = rows

    def cut(self, rows):
        self.rows = min(rows, self.rows)

    def end(self):
        """Return the end of the data in the file."""
        return 0 if self.address == UNDEFINED else self.address + self.capacity * self.row_bytes

    def layout(self, area):
        return struct.pack("<BBQQ", 3, 1, self.address, self.rows * self.row_bytes)


class Chunked(Dataset):
    """Chunks of ``chunk_rows`` rows. Rows beyond the committed ones are invisible to readers,
    so the last chunk is filled in place; full index nodes are written once, for good."""

    fill = 0x0B  # allocated incrementally, filled if set

    def __init__(self, dtype, tail, chunk_rows, **attrs):
        super().__init__(dtype, tail, **attrs)
        self.chunk_rows = chunk_rows
        self.chunks = []  # addresses
        self.full = [[]]  # addresses of full nodes, by level

    def append(self, file, values):
        values = self.rows_of(values)
        done, c = 0, self.chunk_rows
        while done < len(values):
            at = self.rows % c
            if self.rows // c == len(self.chunks):
                self.chunks.append(file.allocate(c * self.row_bytes))
            part = values[done : done + c - at]
            file.write(part, self.chunks[self.rows // c] + at * self.row_bytes)
            self.rows += len(part)
            done += len(part)

    def cut(self, rows):
        self.rows = min(rows, self.rows)
        self.chunks = self.chunks[: -(-self.rows // self.chunk_rows)]
        span = FANOUT
        for level, nodes in enumerate(self.full):
            self.full[level] = nodes[: len(self.chunks) // span]
            span *= FANOUT

    def end(self):
        """Return the end of the data; chunks lie in ascending order, index nodes do not count."""
        return self.chunks[-1] + self.chunk_rows * self.row_bytes if self.chunks else 0

    @property
    def node_bytes(self):
        return 24 + 8 * FANOUT + (FANOUT + 1) * self._key_bytes

    @property
    def _key_bytes(self):
        return 8 + 8 * (len(self.tail) + 2)

    def _key(self, chunk, last=False):
        """Return the key of a chunk; the last key of a node bounds its chunks from above."""
        size = 0 if last else self.chunk_rows * self.row_bytes
        rest = (*self.tail, self.dtype.itemsize) if last else (0,) * (len(self.tail) + 1)
        return struct.pack(f"<IIQ{len(rest)}Q", size, 0, chunk * self.chunk_rows, *rest)

    def _node(self, level, children, first):
        """Return a node over ``children`` (addresses), whose first chunk is ``first``."""
        span = FANOUT**level
        parts = [b"TREE", struct.pack("<BBHQQ", 1, level, len(children), UNDEFINED, UNDEFINED)]
        for k, address in enumerate(children):
            parts += [self._key(first + k * span), struct.pack("<Q", address)]
        parts.append(self._key(min(first + len(children) * span, len(self.chunks)), last=True))
        return b"".join(parts).ljust(self.node_bytes, b"\0")

    def write_full_nodes(self, file):
        """Write the index nodes that became full since the last commit."""
        level, children = 0, self.chunks
        while len(children) >= FANOUT:
            if level == len(self.full):
                self.full.append([])
            nodes = self.full[level]
            while (len(nodes) + 1) * FANOUT <= len(children):
                first = len(nodes)
                data = self._node(
                    level, children[first * FANOUT : (first + 1) * FANOUT], first * FANOUT ** (level + 1)
                )
                nodes.append(file.allocate(len(data)))
                file.write(data, nodes[-1])
            level, children = level + 1, nodes

    def layout(self, area):
        root = UNDEFINED
        edge = []  # the one incomplete node below, if any
        children, level = self.chunks, 0
        while children or edge:
            full = self.full[level] if level < len(self.full) else []
            rest = children[len(full) * FANOUT :] + edge
            if not rest and len(full) == 1:
                root = full[0]
                break
            edge = [area.add(self._node(level, rest, len(full) * FANOUT ** (level + 1)))] if rest else []
            if not full:
                root = edge[0]
                break
            children, level = full, level + 1
        dims = (self.chunk_rows, *self.tail, self.dtype.itemsize)
        return struct.pack(f"<BBBQ{len(dims)}I", 3, 2, len(dims), root, *dims)


class File:
    """The file itself: allocation, positioned writes, `commit`."""

    def __init__(self, path, mode, sync=True):
        self.descriptor = os.open(
            path, mode | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0), 0o666
        )
        self.end = 512  # the superblock has the first sector to itself
        self.committed_end = 0
        self.areas = []  # (address, capacity)
        self.commits = 0
        self.sync = sync

    def allocate(self, size):
        address = self.end
        self.end += size + (-size) % 8
        return address

    def write(self, data, address):
        view = (
            memoryview(np.ascontiguousarray(data)).cast("B")
            if isinstance(data, np.ndarray)
            else memoryview(data)
        )
        while len(view):
            done = os.pwrite(self.descriptor, view, address)
            view, address = view[done:], address + done

    def read(self, size, address):
        return os.pread(self.descriptor, size, address)

    def commit(self, root):
        """Make everything below ``root`` the content of the file, at once."""
        for _, item in root.walk():
            if isinstance(item, Chunked):
                item.write_full_nodes(self)
        trial = Area(0, final=False)
        root.place(trial)
        slot = self.commits % AREAS
        if slot >= len(self.areas) or self.areas[slot][1] < trial.size:
            capacity = trial.size + trial.size // 4
            self.areas[slot : slot + 1] = [(self.allocate(capacity), capacity)]
        area = Area(self.areas[slot][0], final=True)
        address = root.place(area)
        self.write(b"".join(area.parts), area.base)
        if os.fstat(self.descriptor).st_size < self.end:
            os.ftruncate(self.descriptor, self.end)  # the reserve of the last chunk
        if self.sync:
            os.fsync(self.descriptor)
        self.write(superblock(address, self.end), 0)
        if self.sync:
            os.fsync(self.descriptor)
        self.commits += 1
        self.committed_end = self.end

    def discard(self):
        """Give back what lies behind the last commit."""
        os.ftruncate(self.descriptor, self.committed_end)

    def close(self):
        if self.descriptor is not None:
            os.close(self.descriptor)
            self.descriptor = None
