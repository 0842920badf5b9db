"""Run CPU stages with one, two and three threads, and report outputs that differ in any bit.

``python -m melt.check.threads``, in a process where MELT_PARALLEL is on and numba has three threads.
"""

import sys

import numba

from melt import _compile
from melt.check.compare import run_stage
from melt.check.inputs import make
from melt.stages import STAGES


def differing(stage, precision, n, seed=0):
    """Return the fields of a CPU stage that depend on the number of threads."""
    arrays, params, _ = make(stage, precision, n, seed)
    runs = []
    for threads in (1, 2, 3, 2):
        numba.set_num_threads(threads)
        runs.append(run_stage(stage, "cpu", arrays, params))
    return [f for f in runs[0] if any(run[f].tobytes() != runs[0][f].tobytes() for run in runs[1:])]


def main(stages=None, precision="single", sizes=(1003, 730, 847)):
    """Print ``stage field ...`` for each stage that differs; return the exit status."""
    if not _compile.PARALLEL or numba.config.NUMBA_NUM_THREADS < 3:
        raise SystemExit("start this with MELT_PARALLEL=1 and NUMBA_NUM_THREADS=3 in the environment")
    bad = 0
    for stage in stages or STAGES:
        # for each size the shares of the threads end elsewhere: vector bodies and remainders must round alike
        fields = sorted({field for n in sizes for field in differing(stage, precision, n)})
        bad += bool(fields)
        print(stage, *(fields or ["same"]), flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
