"""Every stage on every backend that needs no device, against the reference and against each other."""

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


@pytest.mark.parametrize("stage, precision", [(s, p) for s in STAGES for p in precisions(s)])
def test_cpu_and_emulated_cuda_agree_with_the_reference(stage, precision):
    rows = check_stage(stage, precision, ("cpu", "cuda-emulated"), n=301)
    red = [row for row in rows if not row.ratio <= 1]
    assert rows and not red, say(red)


def test_simulated_cuda_agrees_with_the_reference():
    from melt import _compile

    if _compile.CUDA_MISSING:
        pytest.skip(_compile.CUDA_MISSING)
    rows = simulate(list(STAGES), ["single"])
    red = [row for row in rows if not row.ratio <= 1]
    assert {row.stage for row in rows} == set(STAGES)
    assert not red, say(red)
