"""Compile the CPU stages of a run before its first step, in child processes, into the cache.

Two reasons. Two children on two cores take half the time of compiling as the step meets each stage.
And a process that compiles a parallel stage does not run the code that it stores: numba keeps the
loop body both as it was compiled alone and as it was optimised again inside the stage, runs the
first one and stores the second, and the two may round differently (measured: `region_rest`). So
that a run, its repetition and its resumption agree to the last bit, every process loads.

A child (`child`) reads a pickled line per stage from stdin, with all types that it is wanted for, and
answers with a line when they are in the cache.
"""

import base64
import json
import os
import pickle
import queue
import subprocess
import sys
import threading
import time

from filelock import FileLock

from melt import _compile
from melt.check import _flood_values
from melt.check._choices import SCALARS
from melt.check.compare import stage_function
from melt.fields import CARRIED
from melt.stages import STAGES

_ready = set()  # (stage, types) that this process has found in the cache


def signatures(do, stages, renamed):
    """Return [(stage name, numba types of its arguments)] of the stages that a bound run may launch."""
    calls = []
    for name in stages:
        stage = STAGES[name]
        if name.startswith("reorder_"):
            ndim = 1 if name == "reorder_scalar" else 2
            carried = [do.state.get(field) for field in CARRIED if field in do.state]
            calls += [(name, [do.state.get("order"), a, a]) for a in carried if len(a.shape) == ndim]
        else:
            known = SCALARS | (_flood_values.SCALARS if stage.file.startswith("flood") else {})
            scalars = {p: known[p] for p in stage.params if p in known} | renamed.get(name, {})
            calls.append((name, do.arguments(stage, scalars)))
    return list(dict.fromkeys((name, tuple(_compile.typeof(a) for a in arguments)) for name, arguments in calls))


def _missing(calls):
    """Return {stage name: [types]} of the calls that are not in the cache."""
    missing = {}
    for call in calls:
        if call not in _ready:
            name, types = call
            dispatcher = stage_function(name, "cpu")
            if dispatcher._cache.load_overload(types, dispatcher.targetctx) is None:
                missing.setdefault(name, []).append(types)
            else:
                _ready.add(call)
    return missing


def compile_ahead(do, stages, renamed=None, progress=None):
    """Bring every CPU stage of a run into the cache; return the seconds that it took.

    ``progress("compile", message=..., done=..., total=...)`` hears of it if there is anything to do.
    Where the cache or a child process cannot be had, stages are compiled as the first step meets them.
    """
    if do.backend.folder != "cpu" or not _compile.CACHED:
        return 0.0
    calls = signatures(do, stages, renamed or {})
    if not _missing(calls):
        return 0.0
    start = time.perf_counter()
    say = progress or (lambda event, **values: None)
    with FileLock(_compile.CACHE_FOLDER / "ahead.lock"):  # another run may be at the same stages: wait, then load
        missing = _missing(calls)
        if missing:
            _share_out(missing, say)
            left = sum(map(len, _missing(calls).values()))
            if left:
                advice = "they are compiled as the first step meets them, and may round differently from later runs"
                say("warning", message=f"{left} stages could not be compiled ahead: {advice}")
    return time.perf_counter() - start


def _share_out(missing, say):
    """Compile with one child per core; all types of a stage go to the same one."""
    work, done, children = queue.SimpleQueue(), [], []
    for item in missing.items():
        work.put(item)

    def tell():
        say("compile", message="compiling stages (cached for the next run)", done=len(done), total=len(missing))

    tell()
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    hands = [
        threading.Thread(target=_feed, args=(work, done, children, tell), daemon=True)
        for _ in range(min(cores, 8, len(missing)))
    ]
    for hand in hands:
        hand.start()
    try:
        for hand in hands:
            while hand.is_alive():  # a join without a limit would not hear Ctrl-C
                hand.join(0.1)
    finally:
        for child in children:
            child.kill()


def _feed(work, done, children, tell):
    """Hand out work to one child until there is none."""
    path = json.dumps([p or os.getcwd() for p in sys.path])
    code = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from melt.ahead import child; child()"
    try:  # -P: nothing is imported from the folder that the user happens to be in
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", code, path],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        )
    except (OSError, TypeError):  # no interpreter to start (an embedded one), or no right to
        return
    children.append(process)
    while True:
        try:
            item = work.get_nowait()
            process.stdin.write(base64.b64encode(pickle.dumps(item)) + b"\n")
            process.stdin.flush()
            answer = process.stdout.readline()
        except (queue.Empty, OSError):
            break
        if not answer:
            break  # it died
        done.append(item)
        tell()
    process.kill()
    process.wait()
    process.stdin.close()
    process.stdout.close()


def child():
    """Compile what stdin names until it closes."""
    for line in sys.stdin.buffer:
        name, wanted = pickle.loads(base64.b64decode(line))
        for types in wanted:
            stage_function(name, "cpu").compile(types)
        print(name, flush=True)
