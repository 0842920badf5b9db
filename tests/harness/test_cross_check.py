"""Every stage on every backend that needs no device, against the reference and against each other."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from melt.check.report import check_stage, simulate
from melt.fields import FIELDS
from melt.stages import STAGES


def precisions(stage):
    """``mixed`` differs from ``single`` only where positions take part."""
    fields = STAGES[stage].reads + STAGES[stage].writes
    mixed = any(f in FIELDS and FIELDS[f].kind == "position" for f in fields)
    return ("single", "mixed", "double") if mixed else ("single", "double")


def say(rows):
    """One line per red row."""
    return "\n".join(
        f"{r.stage}.{r.field} ({r.precision}) on {r.backend} against {r.against}: "
        f"ratio {r.ratio:.3g} at {r.index}, "
        f"{r.reference!r} / {r.got!r} {r.variant} {r.message}"
        for r in rows
    )


CASES = [(s, p) for s in STAGES for p in precisions(s)]
FROM_THE_END = """
import sys; from melt.check.report import check_stage
for case in sys.argv[:0:-1]: check_stage(*case.split(","), ("cpu", "cuda-emulated"), n=301)
"""


@pytest.fixture(scope="module", autouse=True)
def _a_second_compiler(request):
    """Another process compiles from the end of the list, where all of it is asked for: what it has done comes from the cache."""
    if len(request.session.items) < len(CASES):
        yield
        return
    child = subprocess.Popen([sys.executable, "-c", FROM_THE_END, *(",".join(case) for case in CASES)])
    yield
    child.kill()
    child.wait()


@pytest.mark.parametrize("stage, precision", CASES)
def test_cpu_and_emulated_cuda_agree_with_the_reference(stage, precision):
    rows = check_stage(stage, precision, ("cpu", "cuda-emulated"), n=301)
    red = [row for row in rows if not row.ratio <= 1]
    assert rows and not red, say(red)


def test_simulated_cuda_agrees_with_the_reference():
    from melt import _compile

    if _compile.CUDA_MISSING:
        pytest.skip(_compile.CUDA_MISSING)
    stages = list(STAGES)
    with ThreadPoolExecutor(2) as pool:  # each starts a process of its own
        rows = [row for part in pool.map(lambda k: simulate(stages[k::2], ["single"]), range(2)) for row in part]
    red = [row for row in rows if not row.ratio <= 1]
    assert {row.stage for row in rows} == set(STAGES)
    assert not red, say(red)
