"""The error table: every stage, field and precision on every backend, as worst error over tolerance.

``python -m melt.check.report`` or ``melt check``. The simulator runs in a process of its own.
"""

import datetime
import json
import os
import platform
import subprocess
import sys
import tempfile
import traceback
from importlib import metadata
from typing import NamedTuple

import h5py
import numpy as np
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from melt import _compile
from melt.check.compare import compare_outputs, run_stage
from melt.check.inputs import choices, make
from melt.stages import STAGES

BACKENDS = ("reference", "cpu", "cuda-emulated", "cuda-simulated")
PRECISIONS = ("single", "mixed", "double")
#: What each backend is held against. Reference: wrong physics; CPU: wrong porting.
AGAINST = {
    "cpu": ("reference",),
    "cuda-emulated": ("reference", "cpu"),
    "cuda-simulated": ("reference",),
    "cuda": ("reference", "cpu"),
}
SIMULATED_SIZE = 251  # more than a few hundred threads take minutes in the simulator
VARIANT_SIZE = 157  # bodies need 150; some references are loops over pairs in Python


class Row(NamedTuple):
    """Worst element of one field over all variants of the input. ``ratio`` <= 1 passes."""

    stage: str
    field: str
    precision: str
    backend: str
    against: str
    ratio: float
    index: tuple = ()
    reference: float = 0.0
    got: float = 0.0
    variant: str = ""
    message: str = ""


def _outputs(stage, backend, arrays, params):
    """Return (outputs, "") or (None, what went wrong). A stage that is missing or fails is red."""
    try:
        return run_stage(stage, backend, arrays, params), ""
    except Exception as error:  # noqa: BLE001  (whatever a stage raises belongs in the table)
        if os.environ.get("MELT_CHECK_DEBUG"):
            traceback.print_exc()
        lines = [line for line in str(error).splitlines() if line.strip()]
        return None, f"{type(error).__name__}: {lines[0].strip() if lines else ''}"


def _failed(stage, precision, backend, message, variant):
    return Row(stage, "-", precision, backend, "-", np.inf, variant=str(variant or ""), message=message)


def check_stage(stage, precision, backends=("cpu", "cuda-emulated"), n=301, seed=0, variants=None):
    """Return the rows of one stage in one precision: the worst over all variants of its input."""
    worst = {}

    def keep(row):
        key = (row.field, row.backend, row.against)
        if key not in worst or row.ratio > worst[key].ratio:
            worst[key] = row

    for k, choice in enumerate(choices(stage) if variants is None else variants):
        try:
            # the base case at full size, its variants at one that is quick
            arrays, params, scales = make(
                stage, precision, n if k == 0 else min(n, VARIANT_SIZE), seed, choice
            )
        except Exception as error:  # noqa: BLE001
            keep(_failed(stage, precision, "input", f"{type(error).__name__}: {error}", choice))
            continue
        outputs = {}
        for backend in ("reference", *backends):
            outputs[backend], message = _outputs(stage, backend, arrays, params)
            if message:
                keep(_failed(stage, precision, backend, message, choice))
        for backend in backends:
            for other in AGAINST[backend]:
                if outputs[backend] is None or outputs.get(other) is None:
                    continue
                found = compare_outputs(stage, outputs[other], outputs[backend], precision, scales)
                for field, d in found.items():
                    keep(
                        Row(
                            stage,
                            field,
                            precision,
                            backend,
                            other,
                            d.ratio,
                            d.index,
                            d.reference,
                            d.got,
                            str(choice or ""),
                        )
                    )
    return list(worst.values())


def simulate(stages, precisions, seed=0, n=SIMULATED_SIZE):
    """Return the rows of backend ``cuda-simulated``, from a process where numba simulates CUDA."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "rows.json")
        job = json.dumps(dict(stages=list(stages), precisions=list(precisions), seed=seed, n=n, out=out))
        environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}
        done = subprocess.run(
            [sys.executable, "-m", "melt.check.simulated", job],
            env=environment,
            capture_output=True,
            text=True,
        )
        if done.returncode or not os.path.exists(out):
            tail = done.stderr.strip().splitlines()[-1:] or ["no message"]
            return [
                _failed(s, p, "cuda-simulated", f"simulator process failed: {tail[0]}", "")
                for s in stages
                for p in precisions
            ]
        with open(out) as file:
            return [Row(**{**row, "index": tuple(row["index"])}) for row in json.load(file)]


def versions():
    """Return the versions of what computes, as attributes of the report."""
    found = {"python": platform.python_version(), "machine": platform.machine()}
    for package in ("numba", "numpy", "llvmlite", "scipy", "numba-cuda"):
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "not installed"
    return found


def write(rows, path, **attributes):
    """Write the table to HDF5: one dataset per column, attributes for versions, seed, size."""
    text = h5py.string_dtype()
    with h5py.File(path, "w") as file:
        for column in Row._fields:
            values = [getattr(row, column) for row in rows]
            if column in ("ratio", "reference", "got"):
                file[column] = np.array(values, dtype=np.float64)
            else:
                file.create_dataset(column, data=[str(v) for v in values], dtype=text)
        file["ratio"].attrs["meaning"] = "worst error / tolerance; passes if <= 1"
        file.attrs["written"] = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        for name, value in {**versions(), **attributes}.items():
            file.attrs[name] = value


def show(rows, console=None):
    """Print one line per stage, field and precision, a column per comparison, then the red ones in full."""
    console = console or Console()
    pairs = list(dict.fromkeys((r.backend, r.against) for r in rows if r.message == ""))
    pairs.sort(key=lambda pair: (pair[1] != "reference", pair[0]))
    table = Table(title="worst error / tolerance (passes if <= 1)")
    for column in ("stage", "field", "precision"):
        table.add_column(column, no_wrap=True)
    for backend, against in pairs:
        table.add_column(f"{backend}\nvs {against}", justify="right")
    cells = {}
    for row in rows:
        if row.message == "":
            cells.setdefault((row.stage, row.field, row.precision), {})[row.backend, row.against] = row.ratio
    for key, found in cells.items():
        values = [f"{found[p]:.2g}" if p in found else "" for p in pairs]
        table.add_row(*key, *values, style="" if max(found.values()) <= 1 else "bold red")
    console.print(table)
    for row in rows:
        if not row.ratio <= 1:
            what = row.message or (
                f"field {row.field} at {row.index}: {row.against} {row.reference:.9g}, "
                f"{row.backend} {row.got:.9g}, {row.ratio:.3g} times the tolerance"
            )
            console.print(
                f"RED {row.stage} ({row.precision}) on {row.backend}: {what} {row.variant}",
                style="red",
                markup=False,
                highlight=False,
            )


def main(stages=None, backends=BACKENDS, precisions=PRECISIONS, n=1003, seed=0, out=None, console=None):
    """Check stages on backends, print the table, write it to ``out``; return the exit status.

    Raises:
        ValueError: an unknown stage, backend or precision.
    """
    stages = list(STAGES) if not stages else list(stages)
    for given, known in ((stages, STAGES), (backends, (*BACKENDS, "cuda")), (precisions, PRECISIONS)):
        for name in given:
            if name not in known:
                raise ValueError(f"unknown {name!r}: use one of {', '.join(known)}")
    console = console or Console()
    direct = [b for b in backends if b not in ("reference", "cuda-simulated")]
    rows = []
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("checking (compiles each stage)", total=len(stages) * len(precisions))
        for stage in stages:
            for precision in precisions:
                progress.update(task, description=f"{stage} ({precision})")
                rows += check_stage(stage, precision, direct, n, seed)
                progress.advance(task)
    missing = _compile.CUDA_MISSING
    if "cuda-simulated" in backends and missing:
        console.print(f"skipped: cuda-simulated needs numba-cuda, and {missing}", markup=False)
    elif "cuda-simulated" in backends:
        console.print("simulating CUDA in a process of its own ...")
        rows += simulate(stages, precisions, seed)
    order = {stage: k for k, stage in enumerate(stages)}
    rows.sort(key=lambda r: (order[r.stage], r.field, r.precision, r.backend, r.against))
    show(rows, console)
    red = [row for row in rows if not row.ratio <= 1]
    console.print(
        f"{len(rows)} comparisons of {len(stages)} stages, {len(red)} red, "
        f"worst ratio {max((r.ratio for r in rows), default=0):.3g}"
    )
    if out:
        write(rows, out, seed=seed, n=n, red=len(red))
        console.print(f"written to {out}")
    return 1 if red else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or None))
