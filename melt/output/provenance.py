"""Where a run comes from: versions, commit, machine, command."""

import datetime
import importlib.metadata
import os
import pathlib
import platform
import shlex
import subprocess
import sys

_PACKAGES = ("numba", "llvmlite", "numpy", "h5py", "numba-cuda")


def provenance(backend="", precision="", threads=None, seed=None):
    """Return what `RunWriter` files under ``/melt/provenance``: name -> str or int.

    Packages that are not installed, and the commit outside of a checkout, are left out.
    """
    facts = {"melt": version("melt"), "python": platform.python_version()}
    facts |= {name.replace("-", "_"): version(name) for name in _PACKAGES}
    facts |= commit(pathlib.Path(__file__).parent)
    facts |= {"backend": backend, "precision": precision}
    facts |= {} if threads is None else {"threads": int(threads)}
    facts |= {} if seed is None else {"seed": int(seed)}
    facts |= {
        "machine": platform.node(),
        "processor": processor(),
        "cores": os.cpu_count() or 0,
        "system": platform.platform(),
        "command": shlex.join(sys.argv),
        "started": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
    }
    return {name: value for name, value in facts.items() if value != ""}


def version(package):
    """Return the installed version of a package, "" without it."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return _own_version() if package == "melt" else ""


def _own_version():
    setup = pathlib.Path(__file__).parents[2] / "setup.cfg"  # run from a checkout, not installed
    lines = setup.read_text().splitlines() if setup.exists() else []
    return next((line.split("=")[1].strip() for line in lines if line.startswith("version")), "")


def commit(folder):
    """Return the git commit of a checkout and whether it was changed since; {} outside of one."""

    def git(*words):
        return subprocess.run(
            ["git", "-C", str(folder), *words], capture_output=True, text=True, timeout=10, check=True
        ).stdout.strip()

    try:
        # an installed melt may lie inside somebody else's checkout: ask about a file of ours
        git("ls-files", "--error-unmatch", "output/provenance.py")
        return {"commit": git("rev-parse", "HEAD"), "dirty": int(bool(git("status", "--porcelain", "-uno")))}
    except (OSError, subprocess.SubprocessError):
        return {}


def processor():
    """Return the name of the processor, as the system gives it."""
    try:
        with open("/proc/cpuinfo") as file:
            names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
        return names[0] if names else platform.machine()
    except OSError:
        return platform.processor() or platform.machine()
