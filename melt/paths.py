"""Paths as users write them."""


def is_file(path, folder=False):
    """Return whether a file (or a folder) is there; a name that none can have (too long, with a null) is of none."""
    try:
        return path.is_dir() if folder else path.is_file()
    except (OSError, ValueError):
        return False
