"""Compile policy: the only module that imports ``njit``, ``prange`` or ``cuda``.

Three decorators, one per kind of compiled function:

``scalar``      a formula of `melt.physics`, callable from both twins
``cpu_stage``   the public function of a CPU stage (``parallel=True``)
``cuda_kernel`` a private CUDA kernel; `Kernel.launch` runs it on a device, in the
                simulator, or emulated on the host, as `melt.backend` has chosen

``scalar_lookup`` is a ``scalar`` that takes arrays. ``cpu_helper`` compiles a serial function used inside CPU stages.

Switches (read once, at import): ``MELT_PARALLEL=0`` compiles the CPU stages without
threads, ``MELT_CACHE_DIR`` moves the cache of compiled code.
"""

import hashlib
import os
import pathlib
import shutil
import sys
import tempfile
import time

import numba
from filelock import FileLock
from numba import njit, prange, typeof  # noqa: F401  (prange and typeof are re-exported)

#: Keeps NaN and infinity honest; without ``reassoc`` nothing vectorises (5-11x slower, measured).
FASTMATH = {"reassoc", "contract", "nsz", "arcp"}
PARALLEL = os.environ.get("MELT_PARALLEL", "1") != "0"
SIMULATED = os.environ.get("NUMBA_ENABLE_CUDASIM", "0") == "1"


def source_hash():
    """Return a short hash of the sources that compiled stages share.

    numba's cache looks only at the file of the function itself, so a changed scalar would
    leave stale callers behind. The cache folder is therefore named by everything a stage may
    call or freeze from elsewhere: `melt.physics`, the parameter tuples, this policy, and the
    private helper files of the twins. (A law test holds that stages import nothing else.)
    """
    root = pathlib.Path(__file__).parent
    shared = [root / "_compile.py", root / "_emulate.py"]
    shared += sorted(root.glob("params*.py")) + sorted(root.glob("physics/*.py")) + sorted(
        p for side in ("cpu", "cuda") for p in root.glob(f"{side}/_*.py")
    )
    digest = hashlib.sha256(numba.__version__.encode())
    for path in shared:
        digest.update(str(path.relative_to(root)).encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def cache_root():
    """Return the folder that holds one cache folder per version of the source."""
    if "MELT_CACHE_DIR" in os.environ:
        return pathlib.Path(os.environ["MELT_CACHE_DIR"])
    if sys.platform == "win32":
        base = pathlib.Path(os.environ.get("LOCALAPPDATA", pathlib.Path.home()))
    else:
        base = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache"))
    return base / "melt"


CACHE_FOLDER = cache_root() / f"{source_hash()}{'' if PARALLEL else '-serial'}"
KEPT_DAYS = 30


def prepare_cache():
    """Make the cache folder, drop those of versions unused for a month; return whether it can be written."""
    try:
        CACHE_FOLDER.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=CACHE_FOLDER):
            os.utime(CACHE_FOLDER)
    except OSError:  # a read-only home, or a folder of another user: compile in memory
        return False
    for other in CACHE_FOLDER.parent.iterdir():
        name = other.name.removesuffix("-serial")
        ours = len(name) == 16 and set(name) <= set("0123456789abcdef") and other.is_dir()
        if ours and other.stat().st_mtime < time.time() - KEPT_DAYS * 86400:
            shutil.rmtree(other, ignore_errors=True)
    return True


CACHED = prepare_cache()
if CACHED:
    numba.config.CACHE_DIR = str(CACHE_FOLDER)
    #: Held while numba changes the index of a function: it reads, changes and writes it without a lock of
    #: its own, and of two processes that do so one would lose its entry, or find the other's code under it.
    _INDEX_LOCK = FileLock(CACHE_FOLDER / "index.lock")


def _cached(dispatcher):
    """Return a dispatcher that shares its cache with other processes safely."""
    if CACHED:
        cache = dispatcher._cache
        save = cache.save_overload

        def save_alone(*overload):
            with _INDEX_LOCK:
                save(*overload)

        cache.save_overload = save_alone
    return dispatcher


def scalar(function):
    """Compile a scalar formula for both twins: no fastmath, no threads, 1/0 is inf.

    fastmath is off explicitly: a callee that says nothing inherits the flags of whichever caller
    compiles it first, and its rounding would depend on the state of the cache. It costs nothing
    (measured: density 1.10, force 2.63 ns per pair on one thread, as with the flags).
    """
    return _cached(njit(error_model="numpy", fastmath=False, cache=CACHED)(function))


def scalar_lookup(function):
    """Compile a scalar formula that looks into arrays; plain Python in the simulator, whose arrays cannot be handed over."""
    return function if SIMULATED else scalar(function)


def cpu_stage(function):
    """Compile a CPU stage: threads, vectorised sums, no bounds checks, no exceptions."""
    options = dict(parallel=PARALLEL, fastmath=FASTMATH, error_model="numpy", nogil=True, cache=CACHED)
    return _cached(njit(**options)(function))


def cpu_helper(function):
    """Compile a serial function that CPU stages call."""
    return _cached(njit(fastmath=FASTMATH, error_model="numpy", nogil=True, cache=CACHED)(function))


def cpu_serial(function):
    """Compile a CPU stage that has no loop worth sharing between threads."""
    return _cached(njit(error_model="numpy", fastmath=False, nogil=True, cache=CACHED)(function))


# --- CUDA -------------------------------------------------------------------------------
from melt._emulate import cuda_standin, emulate  # noqa: E402

try:
    import numba_cuda  # noqa: F401  (numba's own copy of the CUDA target is untested: never used)
    from numba import cuda
except ImportError:
    cuda, CUDA_MISSING = cuda_standin, "the package numba-cuda is not installed (pip install 'numba-cuda[cu13]', or [cu12] for CUDA 12)"
else:
    CUDA_MISSING = ""

BLOCK = 8 if SIMULATED else 128
KERNELS = []


class Kernel:
    """One private CUDA kernel. `launch` runs it where `Kernel.emulated` says."""

    #: True: launches run on host arrays, thread after thread (backend ``cuda-emulated``).
    emulated = False
    #: A function of (kernel, arguments) that is called instead of running anything (see `melt.check.ptx`).
    recorder = None

    def __init__(self, function):
        self.py_func = function
        self._device = self._host = None
        KERNELS.append(self)

    def launch(self, threads, *arguments):
        """Run the kernel with at least ``threads`` threads; nothing happens for 0."""
        if threads <= 0:
            return
        if Kernel.recorder is not None:
            Kernel.recorder(self, arguments)
            return
        if Kernel.emulated:
            if self._host is None:
                self._host = emulate(self.py_func, cache=CACHED)
                _cached(self._host.body)
            self._host(threads, *arguments)
            return
        if self._device is None:
            self._device = cuda.jit(self.py_func)
        self._device[-(-threads // BLOCK), BLOCK](*arguments)


def cuda_kernel(function):
    """Mark a private kernel; nothing is compiled before its first launch."""
    return Kernel(function)


def device_empty(shape, dtype):
    """Return an uninitialised array where kernels of the CUDA twin can write it."""
    import numpy as np

    return np.empty(shape, dtype) if Kernel.emulated else cuda.device_array(shape, dtype)
