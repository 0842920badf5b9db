"""The single place that chooses a backend."""

import os
from typing import NamedTuple

import numpy as np

from melt import _compile
from melt.errors import MeltError

NAMES = ("reference", "cpu", "cuda", "cuda-emulated", "cuda-simulated")


class Backend(NamedTuple):
    """Where stages come from (`melt.<folder>`), where arrays live, and why it was taken."""

    name: str
    folder: str
    on_device: bool
    reason: str

    def upload(self, array):
        """Return a contiguous copy of a NumPy array where the stages can use it."""
        array = np.array(array, order="C", copy=True)
        return _compile.cuda.to_device(array) if self.on_device else array

    def download(self, array):
        """Return a NumPy copy of an array of this backend."""
        return array.copy_to_host() if self.on_device else array.copy()

    def synchronize(self):
        """Wait for the device; nothing to wait for elsewhere."""
        if self.on_device and not _compile.SIMULATED:
            _compile.cuda.synchronize()


def why_no_device():
    """Return why CUDA cannot be used here, or an empty string if it can."""
    if _compile.CUDA_MISSING:
        return _compile.CUDA_MISSING
    if _compile.SIMULATED:
        return "NUMBA_ENABLE_CUDASIM=1 replaces the device by the simulator"
    if not _compile.cuda.is_available():
        return "no CUDA device or driver was found"
    return ""


def load(name="auto"):
    """Return the `Backend` called ``name``; ``auto`` takes a CUDA device if there is one.

    Raises:
        MeltError: unknown name, or the backend cannot run here (with the remedy).
    """
    if name == "auto":
        obstacle = why_no_device()
        if obstacle:
            return Backend("cpu", "cpu", False, f"auto: {obstacle}")
        name, reason = "cuda", "auto: a CUDA device was found"
    elif name in NAMES:
        reason = "as asked"
    else:
        raise MeltError(f"unknown backend {name!r}: use auto, {', '.join(NAMES)}")
    if name in ("reference", "cpu"):
        return Backend(name, name, False, reason)
    if name == "cuda-emulated":
        _compile.Kernel.emulated = True
        return Backend(name, "cuda", False, reason)
    if name == "cuda-simulated":
        if not _compile.SIMULATED or _compile.CUDA_MISSING:
            raise MeltError(
                "backend 'cuda-simulated' needs its own process and the package numba-cuda: "
                "start melt with NUMBA_ENABLE_CUDASIM=1 in the environment"
            )
        _compile.Kernel.emulated = False
        return Backend(name, "cuda", True, reason)
    obstacle = why_no_device()
    if obstacle:
        raise MeltError(
            f"backend 'cuda' cannot run here: {obstacle}. Use --backend cpu, or cuda-emulated to check kernels"
        )
    _compile.Kernel.emulated = False
    return Backend("cuda", "cuda", True, reason)


def check_memory(wanted):
    """Refuse a run that needs more memory [bytes] than this machine has, before the system ends it.

    Raises:
        MeltError: says how much is needed and what to lower.
    """
    try:
        there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # unknown on some systems
        return
    if wanted > there:
        raise MeltError(
            f"the run needs {wanted / 1e9:.3g} GB of memory, this machine has {there / 1e9:.3g} GB: raise the spacing, "
            "make the scene smaller, or lower solver.max_neighbours and solver.width"
        )


def set_threads(threads):
    """Use this many CPU threads (all that the process may use for None)."""
    if threads:
        import numba

        if not 1 <= threads <= numba.config.NUMBA_NUM_THREADS:
            raise MeltError(f"threads: got {threads}, this process allows 1 to {numba.config.NUMBA_NUM_THREADS}")
        numba.set_num_threads(threads)
