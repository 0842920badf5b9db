"""``melt reproduce NAME``: run one experiment and print its table, paper beside ours."""

import importlib
import pathlib
import tempfile

from melt.errors import MeltError


def experiments():
    """Return the package of experiments: installed as `melt.experiments`, or of the source tree."""
    import sys

    try:
        import experiments as package
    except ImportError:
        package = importlib.import_module("melt.experiments")
        sys.modules["experiments"] = package
    return package


def names():
    """Return the names that `run` takes."""
    return experiments().names()


def run(name, out=None, quick=False, say=print):
    """Run the experiment ``name``, print its rows, keep its HDF5 file at ``out`` if given.

    Returns:
        True if every bound holds.

    Raises:
        MeltError: no such experiment.
    """
    package = experiments()
    if name not in package.names():
        raise MeltError(f"unknown table {name!r}: use one of {', '.join(package.names())}")
    module = package.load(name)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(out) if out else pathlib.Path(folder) / f"{name}.h5"
        module.run(path, quick=quick, say=say)
        rows = module.report(path)
    say("")
    say((module.__doc__ or "").strip().splitlines()[0])
    for row in rows:
        mark = {True: "ok  ", False: "MISS", None: "    "}[row.ok]
        say(
            f"{mark} {row.name}: paper/truth {row.expected}; ours {row.measured}"
            + (f" (bound {row.bound})" if row.bound else "")
        )
        if row.note:
            say(f"       {row.note}")
    return all(row.ok is not False for row in rows)
