"""Files that appear whole or not at all: written under a temporary name beside their own, then renamed."""

import contextlib
import os
import pathlib

from melt.output.errors import output_error


@contextlib.contextmanager
def whole(path, what="write"):
    """Yield a temporary name beside ``path`` (same suffix) that becomes ``path`` if all went well.

    Raises:
        OutputError: it cannot be written there; ``what`` says what was being done.
    """
    path = pathlib.Path(path)
    temporary = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        if path.is_dir():
            raise IsADirectoryError(21, "is a directory")
        temporary.touch()  # a bad place must not cost the drawing
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise output_error(what, path, error) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_whole(path, data):
    """Write bytes; they are on the disk before they have their name.

    Raises:
        OutputError: it cannot be written.
    """
    with whole(path) as temporary, open(temporary, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
