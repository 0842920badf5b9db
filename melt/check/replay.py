"""Replay a capsule: the call of a stage on which a run failed, on every backend. ``melt check --capsule FILE``.

Which backends give the bad value too says where to look: all of them, the inputs or the equations; single precision
alone, a range that it does not have (the reference computes in double); one twin alone, its code; none, memory that
was not what the program wrote, or another program.
"""

import json
import os
import subprocess
import sys
import tempfile
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from melt import _compile
from melt.backend import why_no_device
from melt.check.compare import difference, meaning, run_stage
from melt.check.report import BACKENDS
from melt.stages import STAGES
from melt.watch import capsule

RUN = "the run"
#: Particles beyond which a backend is left out unless it is asked for: it takes minutes.
LARGEST = {"reference": 20_000, "cuda-simulated": 1_500}


class Replay(NamedTuple):
    """What a backend made of the inputs. ``ratio`` <= 1: as the first of those compared, within the tolerance."""

    backend: str
    ratio: float = 0.0
    field: str = ""  # of the largest difference
    not_finite: int = 0  # elements of all outputs
    value: float = 0.0  # of the element that the run was stopped for
    message: str = ""  # why there is no result


def replay(path, backends=None):
    """Return the [`Replay`] of a capsule, that of the run first; others are compared with the first backend that ran.

    Args:
        backends: names; None: all that can run here and do not take minutes.

    Raises:
        RunFileError: no capsule, or a damaged one.
    """
    found = capsule.read(path)
    size = max((a.shape[-1] for a in found.arrays.values() if a.ndim), default=0)
    outputs, messages = {}, {}
    for name in backends or (*BACKENDS, *(() if why_no_device() else ("cuda",))):
        if not backends and size > LARGEST.get(name, size):
            messages[name] = f"left out: {size:,} elements take minutes here; ask for it with --backend {name}"
        elif name.startswith("cuda") and _compile.CUDA_MISSING and name != "cuda-emulated":
            messages[name] = f"left out: {_compile.CUDA_MISSING}"
        elif name == "cuda-simulated" and not _compile.SIMULATED:
            outputs[name], messages[name] = _simulated(path)
        else:
            outputs[name], messages[name] = _outputs(found, name)
    first = next((outputs[name] for name in outputs if outputs[name] is not None), found.outputs)
    rows = [_row(found, RUN, found.outputs, first)]
    for name, message in messages.items():
        made = outputs.get(name)
        rows.append(Replay(name, np.inf if name in outputs else 0.0, message=message) if made is None else _row(found, name, made, first))
    return rows


def _outputs(found, backend):
    """Return (outputs, "") or (None, what went wrong)."""
    try:
        return run_stage(found.stage, backend, found.arrays, found.params), ""
    except Exception as error:  # noqa: BLE001  (whatever a stage raises belongs in the table)
        return None, f"{type(error).__name__}: {str(error).strip().splitlines()[0] if str(error).strip() else ''}"


def _row(found, backend, outputs, first):
    """Compare the outputs of a backend with the first ones."""
    scratch, precision = STAGES[found.stage].scratch, found.facts["precision"]
    worst = ("", 0.0)
    for field, reference in first.items():
        got, mask = outputs[field], meaning(field, first)
        if mask is not None:
            reference, got = np.where(mask, reference, 0), np.where(mask, got, 0)
        ratio = difference(found.stage, field, reference, got, precision, found.scales).ratio
        worst = max(worst, (field, ratio), key=lambda f: f[1])
    bad = sum(int((~np.isfinite(a)).sum()) for n, a in outputs.items() if a.dtype.kind == "f" and n not in scratch)
    return Replay(backend, worst[1], worst[0] if worst[1] > 0 else "", bad, _value(found, outputs))


def _value(found, outputs):
    """Return the element that the run was stopped for; of a speed alarm, the speed of its particle."""
    at, index = found.facts["field"], tuple(found.facts["index"])
    if not at:
        return 0.0
    if found.facts["speed"]:
        return float(np.linalg.norm(outputs[at][:, index[-1]].astype(np.float64)))
    return float(outputs[at][index])


def _simulated(path):
    """Return what a process gives where numba simulates CUDA, as `_outputs`."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "outputs.npz")
        job = json.dumps(dict(capsule=str(path), out=out))
        environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}
        done = subprocess.run(
            [sys.executable, "-m", "melt.check.simulated", job], env=environment, capture_output=True, text=True
        )
        if not os.path.exists(out):
            return None, f"simulator process failed: {(done.stderr.strip().splitlines() or ['no message'])[-1]}"
        with np.load(out) as file:
            return {name: file[name] for name in file.files}, ""


def simulate(path, out):
    """Write the outputs of the simulator to ``out`` (npz); an error of the stage ends the process with its message."""
    made, message = _outputs(capsule.read(path), "cuda-simulated")
    if made is None:
        raise SystemExit(message)
    np.savez(out, **made)


def main(path, backends=None, console=None):
    """Replay a capsule, print the table and what it says; return whether backends, or the run, differ."""
    console = console or Console()
    found, rows = capsule.read(path), replay(path, backends)
    f = found.facts
    what = f"stage {found.stage}, call {f['call']} of step {f['step']}, from t = {f['time']:.6g} s"
    console.print(f"{what}, {f['precision']} precision on {f['backend']}\n{f['alarm']}", markup=False, highlight=False)
    at = f"{'|v| at ' if f['speed'] else ''}{f['field']}[{', '.join(map(str, f['index']))}]" if f["field"] else "-"
    table = Table()
    for k, name in enumerate(("", at, "not finite", "error / tolerance", "")):
        table.add_column(name, justify="right" if 0 < k < 4 else "left", no_wrap=k < 4)
    for r in rows:
        if r.message:
            table.add_row(r.backend, "", "", "", r.message)
        else:
            table.add_row(r.backend, f"{r.value:.6g}", f"{r.not_finite:,}", f"{r.ratio:.2g}", f"in {r.field}" if r.ratio > 1 else "")
    console.print(table)
    console.print(verdict(found, rows), markup=False, highlight=False)
    return not all(r.ratio <= 1 for r in rows)


def verdict(found, rows):
    """Return in words what a replay says."""
    ran = [r for r in rows if not r.message and r.backend != RUN]
    failed = "".join(f"; {r.backend} failed" for r in rows if r.message and r.ratio > 1)
    if not ran:
        return f"no backend could repeat it{failed}"
    most = found.facts["speed"] or np.finfo(float).max
    bad = [r.backend for r in ran if not r.value <= most]
    same = all(r.ratio <= 1 for r in ran)
    good = [r.backend for r in ran if r.backend not in bad]
    if not found.facts["field"]:
        text = "the backends agree on the call" if same else "the backends differ"
    elif not bad:
        text = f"{', '.join(good)}: a good value, that of the run does not come again: its memory or its program was another"
    elif good:
        text = f"bad on {', '.join(bad)}, good on {', '.join(good)}: look at what these do otherwise"
    else:
        text = f"bad on all of {', '.join(bad)}" + (": look at the inputs and the equation" if same else ", with other values")
    return text + failed

