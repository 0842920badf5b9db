"""Errors of files and pictures: one paragraph each, saying what, where and what to do."""

import errno
import os

from melt.errors import MeltError


class OutputError(MeltError):
    """A result could not be written. What was written before stays valid."""


class RunFileError(MeltError, ValueError):
    """A run file or checkpoint cannot be read."""


_REMEDY = {
    errno.ENOSPC: "the disk is full; free some space or name another place with --output, "
    "then continue with `melt resume`",
    errno.EDQUOT: "your disk quota is used up; free some space or name another place with --output, "
    "then continue with `melt resume`",
    errno.EFBIG: "the file would exceed the largest size allowed here (file system or ulimit -f); "
    "write less often or raise the limit, then continue with `melt resume`",
    errno.EACCES: "no permission to write there; name another place with --output",
    errno.EPERM: "no permission to write there; name another place with --output",
    errno.EROFS: "the file system is read-only; name another place with --output",
    errno.ENOENT: "the folder does not exist; make it, or name another place with --output",
    errno.EISDIR: "this is a folder; name a file",
}


def output_error(what, path, error):
    """Return the `OutputError` for an `OSError` met while doing ``what`` to ``path``."""
    remedy = _REMEDY.get(error.errno, f"{os.strerror(error.errno)}" if error.errno else str(error))
    return OutputError(f"cannot {what} {path}: {remedy}.")


def check_hdf5(path, what):
    """Raise `OutputError` if the name of a file of results is not that of an HDF5 file: a picture is drawn beside it."""
    if path.suffix.lower() not in (".h5", ".hdf5"):
        raise OutputError(f"{what} is an HDF5 file, not {path.name}: name it {path.with_suffix('.h5').name}")


def read_error(what, path, error):
    """Return the `RunFileError` for an `OSError` met while opening ``path``."""
    reason = {
        errno.ENOENT: "there is no such file; check the name (`melt run` writes NAME.vtkhdf)",
        errno.EACCES: "no permission to read it",
        errno.EISDIR: "this is a folder; name the run file inside it",
    }.get(error.errno, os.strerror(error.errno) if error.errno else str(error))
    return RunFileError(f"cannot {what} {path}: {reason}.")
