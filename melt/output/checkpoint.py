"""Checkpoints: all arrays of a run in one file, written beside the old one and renamed.

Layout: magic, length of the header, header (JSON: ``meta`` and the table of arrays), the
arrays one behind the other, BLAKE2b digest of all before it. No pickles: a checkpoint from
elsewhere cannot run code.
"""

import hashlib
import json
import os
import pathlib

import numpy as np

from melt.output.errors import OutputError, RunFileError, output_error, read_error

MAGIC = b"melt checkpoint 1\n"
_DIGEST = 32


def beside(run_path):
    """Return where the latest checkpoint of a run file is: ``NAME.vtkhdf.ckpt``."""
    return pathlib.Path(f"{run_path}.ckpt")


def fingerprint(scene_text):
    """Return a short text that two scenes share only if they are the same."""
    return hashlib.blake2b(scene_text.encode(), digest_size=16).hexdigest()


def discard(path):
    """Remove a checkpoint, if there is one.

    Raises:
        OutputError: it could not be removed.
    """
    try:
        pathlib.Path(path).unlink(missing_ok=True)
    except OSError as error:
        raise output_error("remove checkpoint", path, error) from error


def save(path, arrays, meta):
    """Write a checkpoint; an older one at ``path`` is replaced only by a whole new one.

    Args:
        arrays: name -> NumPy array of numbers.
        meta: values that JSON can hold; floats come back with the same bits.

    Raises:
        OutputError: it could not be written; the older one is still there.
    """
    path = pathlib.Path(path)
    arrays = {name: np.asarray(array, order="C") for name, array in arrays.items()}
    for name, array in arrays.items():
        if array.dtype.kind not in "fiub":
            raise OutputError(
                f"array '{name}' of checkpoint {path} has type {array.dtype}; only numbers are kept."
            )
    table = [(name, array.dtype.str, array.shape) for name, array in arrays.items()]
    header = json.dumps({"meta": meta, "arrays": table}).encode()
    temporary = path.with_name(f".{path.name}.part")
    digest = hashlib.blake2b(digest_size=_DIGEST)
    try:
        with open(temporary, "wb") as file:
            for piece in (MAGIC, len(header).to_bytes(8, "little"), header, *arrays.values()):
                data = piece if isinstance(piece, bytes) else piece.reshape(-1).view(np.uint8)
                digest.update(data)
                file.write(data)
            file.write(digest.digest())
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
        sync_folder(path.parent)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise output_error("write checkpoint", path, error) from error
    except BaseException:  # Ctrl-C leaves no half file either
        temporary.unlink(missing_ok=True)
        raise


def load(path):
    """Return (arrays, meta) of a checkpoint.

    Raises:
        RunFileError: there is none, it is damaged, or it is something else.
    """
    try:
        data = pathlib.Path(path).read_bytes()
    except OSError as error:
        raise read_error("read checkpoint", path, error) from error
    if not data.startswith(MAGIC):
        raise RunFileError(f"{path} is no checkpoint of this version of melt (it must begin with {MAGIC!r}).")
    view = memoryview(data)
    body, digest = view[:-_DIGEST], view[-_DIGEST:]
    if hashlib.blake2b(body, digest_size=_DIGEST).digest() != digest:
        raise RunFileError(
            f"checkpoint {path} is damaged: its checksum is wrong. Copy it again, or start the run afresh."
        )
    at = len(MAGIC) + 8
    length = int.from_bytes(view[len(MAGIC) : at], "little")
    header = json.loads(bytes(view[at : at + length]))
    at += length
    arrays = {}
    for name, kind, shape in header["arrays"]:
        dtype, count = np.dtype(kind), int(np.prod(shape, dtype=np.int64))
        arrays[name] = np.frombuffer(data, dtype, count, at).reshape(shape).copy()
        at += count * dtype.itemsize
    return arrays, header["meta"]


def sync_folder(folder):
    """Make a rename in ``folder`` survive a power cut, where the system can."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except OSError:
        return
    try:
        os.fsync(descriptor)
    except OSError:
        pass  # some network file systems cannot
    finally:
        os.close(descriptor)
