"""Encoding of HDF5 metadata: checksum, messages of object headers, superblock.

Format: https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html
"""

import struct

import h5py
import numpy as np

UNDEFINED = 0xFFFFFFFFFFFFFFFF
_MASK = 0xFFFFFFFF


def _rot(x, k):
    return ((x << k) | (x >> (32 - k))) & _MASK


def lookup3(data):
    """Return Jenkins' lookup3 checksum, which HDF5 puts behind its metadata."""
    n = len(data)
    a = b = c = (0xDEADBEEF + n) & _MASK
    if n == 0:
        return c
    words = struct.unpack(f"<{-(-n // 12) * 3}I", data + bytes(-n % 12))
    for k in range(0, len(words) - 3, 3):
        a, b, c = (a + words[k]) & _MASK, (b + words[k + 1]) & _MASK, (c + words[k + 2]) & _MASK
        a = ((a - c) & _MASK) ^ _rot(c, 4)
        c = (c + b) & _MASK
        b = ((b - a) & _MASK) ^ _rot(a, 6)
        a = (a + c) & _MASK
        c = ((c - b) & _MASK) ^ _rot(b, 8)
        b = (b + a) & _MASK
        a = ((a - c) & _MASK) ^ _rot(c, 16)
        c = (c + b) & _MASK
        b = ((b - a) & _MASK) ^ _rot(a, 19)
        a = (a + c) & _MASK
        c = ((c - b) & _MASK) ^ _rot(b, 4)
        b = (b + a) & _MASK
    a, b, c = (a + words[-3]) & _MASK, (b + words[-2]) & _MASK, (c + words[-1]) & _MASK
    for x, y, k in ((2, 1, 14), (0, 2, 11), (1, 0, 25), (2, 1, 16), (0, 2, 4), (1, 0, 14), (2, 1, 24)):
        v = [a, b, c]
        v[x] = ((v[x] ^ v[y]) - _rot(v[y], k)) & _MASK
        a, b, c = v
    return c


def datatype(dtype):
    """Return the encoded datatype message of a NumPy dtype (``S`` becomes a UTF-8 string)."""
    dtype = np.dtype(dtype)
    if dtype.kind == "S":
        kind = h5py.h5t.C_S1.copy()
        kind.set_size(max(dtype.itemsize, 1))
        kind.set_cset(h5py.h5t.CSET_UTF8)
        kind.set_strpad(h5py.h5t.STR_NULLPAD)
    else:
        kind = h5py.h5t.py_create(dtype)
    return kind.encode()[2:]


def dataspace(shape):
    return struct.pack("<BBBB", 2, len(shape), 0, 1 if shape else 0) + struct.pack(f"<{len(shape)}Q", *shape)


def attribute(name, value):
    """Return an attribute message: numbers, arrays, text (UTF-8) or ASCII (``bytes``)."""
    if isinstance(value, str):
        text = value.encode()[:60000] or b"\0"
        value = np.array(text, dtype=f"S{len(text)}")
        kind = datatype(value.dtype)
    elif isinstance(value, bytes):
        value = np.array(value)
        kind = h5py.h5t.py_create(value.dtype).encode()[2:]
    else:
        value = np.asarray(value)
        kind = datatype(value.dtype)
    label = name.encode() + b"\0"
    space = dataspace(value.shape)
    head = struct.pack("<BBHHHB", 3, 0, len(label), len(kind), len(space), 1)
    # tobytes() of an S array keeps its padding, so the size is the one of the datatype
    return 0x0C, head + label + kind + space + np.ascontiguousarray(value).tobytes()


def link(name, address):
    label = name.encode()
    size = 1 if len(label) < 256 else 2
    head = struct.pack("<BBB", 1, 0x10 | (size - 1), 1) + len(label).to_bytes(size, "little")
    return 0x06, head + label + struct.pack("<Q", address)


def object_header(messages, checksum=True):
    body = b"".join(struct.pack("<BHB", kind, len(data), 0) + data for kind, data in messages)
    head = b"OHDR" + struct.pack("<BBI", 2, 0x02, len(body)) + body
    return head + struct.pack("<I", lookup3(head) if checksum else 0)


def superblock(root, end):
    head = (
        b"\x89HDF\r\n\x1a\n"
        + struct.pack("<BBBB", 2, 8, 8, 0)
        + struct.pack("<QQQQ", 0, UNDEFINED, end, root)
    )
    return head + struct.pack("<I", lookup3(head))


class Area:
    """Metadata of one commit, laid out from ``base``; ``final`` if checksums matter."""

    def __init__(self, base, final):
        self.base, self.final, self.parts, self.size = base, final, [], 0

    def add(self, data):
        address = self.base + self.size
        padded = data + bytes(-len(data) % 8)
        self.parts.append(padded)
        self.size += len(padded)
        return address
