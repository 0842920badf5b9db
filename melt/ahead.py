"""Compile the CPU stages of a run before its first step, in child processes, into the cache.

Two reasons. Two children on two cores take half the time of compiling as the step meets each stage.
And a process that compiles a parallel stage does not run the code that it stores: numba keeps the
loop body both as it was compiled alone and as it was optimised again inside the stage, runs the
first one and stores the second, and the two may round differently (measured: `region_rest`). So
that a run, its repetition and its resumption agree to the last bit, every process loads.

``python -m melt.ahead`` is the child: it reads (stage, types) from stdin, one pickled line each, and
answers with a line when that stage is in the cache.
"""

import base64
import os
import pickle
import queue
import subprocess
import sys
import threading
import time

from melt import _compile
from melt.check._choices import SCALARS
from melt.check.compare import stage_function
from melt.fields import CARRIED
from melt.stages import STAGES

_ready = set()  # (stage, types) that this process has found in the cache


def signatures(do, stages):
    """Return [(stage name, numba types of its arguments)] of the stages that a bound run may launch."""
    calls = []
    for name in stages:
        stage = STAGES[name]
        if name.startswith("reorder_"):
            ndim = 1 if name == "reorder_scalar" else 2
            carried = [do.state.get(field) for field in CARRIED if field in do.state]
            calls += [(name, [do.state.get("order"), a, a]) for a in carried if len(a.shape) == ndim]
        else:
            scalars = {p: SCALARS[p] for p in stage.params if p in SCALARS}
            calls.append((name, do.arguments(stage, scalars)))
    return list(dict.fromkeys((name, tuple(_compile.typeof(a) for a in arguments)) for name, arguments in calls))


def compile_ahead(do, stages, progress=None):
    """Bring every CPU stage of a run into the cache; return the seconds that it took.

    ``progress("compile", message=..., done=..., total=...)`` hears of it if there is anything to do.
    Where the cache or a child process cannot be had, stages are compiled as the first step meets them.
    """
    if do.backend.folder != "cpu" or not _compile.CACHED:
        return 0.0
    missing = []
    for call in signatures(do, stages):
        if call not in _ready:
            dispatcher = stage_function(call[0], "cpu")
            if dispatcher._cache.load_overload(call[1], dispatcher.targetctx) is None:
                missing.append(call)
            else:
                _ready.add(call)
    if not missing:
        return 0.0
    start = time.perf_counter()
    work, done = queue.SimpleQueue(), []
    for call in missing:
        work.put(call)

    def tell():
        if progress:
            message = "compiling stages (cached for the next run)"
            progress("compile", message=message, done=len(done), total=len(missing))

    tell()
    hands = [
        threading.Thread(target=_feed, args=(work, done, tell), daemon=True)
        for _ in range(min(os.cpu_count() or 1, 8, len(missing)))
    ]
    for hand in hands:
        hand.start()
    for hand in hands:
        while hand.is_alive():  # a join without a limit would not hear Ctrl-C
            hand.join(0.1)
    _ready.update(done)
    return time.perf_counter() - start


def _feed(work, done, tell):
    """Hand out work to one child until there is none."""
    paths = os.pathsep.join(p or os.getcwd() for p in sys.path)
    try:
        child = subprocess.Popen(
            [sys.executable, "-m", "melt.ahead"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, env={**os.environ, "PYTHONPATH": paths},
        )
    except OSError:
        return
    with child:
        while not work.empty():
            try:
                call = work.get_nowait()
                child.stdin.write(base64.b64encode(pickle.dumps(call)) + b"\n")
                child.stdin.flush()
                if not child.stdout.readline():
                    return  # it died: the stage is compiled when the step meets it
            except (queue.Empty, OSError):
                return
            done.append(call)
            tell()


def _child():
    for line in sys.stdin.buffer:
        name, types = pickle.loads(base64.b64decode(line))
        stage_function(name, "cpu").compile(types)
        print(name, flush=True)


if __name__ == "__main__":
    _child()
