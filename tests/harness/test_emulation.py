"""CUDA kernels on the host: both ways of looping over threads, atomics, types."""

import numpy as np
import pytest

from melt import _emulate
from melt.check.compare import run_stage
from melt.check.inputs import make


def kernel():
    """A kernel as `melt.cuda` writes them, with ``cuda`` among its globals."""
    names = {**globals(), "cuda": None}
    source = (
        "def square(x, hits, largest, y):\n    i = cuda.grid(1)\n    if i >= x.shape[0]:\n        return\n"
        "    y[i] = x[i] * x[i]\n    cuda.atomic.add(hits, 0, 1)\n    cuda.atomic.max(largest, 0, i)\n"
    )
    exec(source, names)
    return names["square"]


@pytest.mark.parametrize("few", [0, 10**6], ids=["compiled loop", "loop in python"])
def test_every_thread_runs_once_and_surplus_threads_return(monkeypatch, few):
    monkeypatch.setattr(_emulate, "FEW", few)
    x = np.arange(1001, dtype=np.float32)
    hits, largest, y = np.zeros(1, np.int32), np.zeros(1, np.int32), np.full(1001, np.nan, np.float32)
    _emulate.emulate(kernel())(1024, x, hits, largest, y)
    assert np.array_equal(y, x * x) and hits[0] == 1001 and largest[0] == 1000


def test_both_loops_give_the_same_bits(monkeypatch):
    arrays, params, _ = make("fluid_force", "single", 301)
    results = []
    for few in (0, 10**6):
        monkeypatch.setattr(_emulate, "FEW", few)
        results.append(run_stage("fluid_force", "cuda-emulated", arrays, params)["force"].tobytes())
    assert results[0] == results[1]


def test_types_are_checked_as_on_a_device():
    """The simulator would run this; a device and the emulation refuse it."""
    names = {"cuda": None}
    exec("def bad(x):\n    i = cuda.grid(1)\n    x[i] = 'a' + 1\n", names)
    with pytest.raises(Exception, match="(?i)typing|no match|invalid|cannot"):
        _emulate.emulate(names["bad"])(1, np.zeros(1))
