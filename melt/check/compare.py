"""Run one stage on one backend with poisoned outputs, and measure the difference of two runs."""

import contextlib
import importlib
from typing import NamedTuple

import numpy as np

from melt import _compile
from melt.fields import FIELDS
from melt.stages import STAGES

SENTINEL = -987654321  # what integer outputs hold before a checked call


class Difference(NamedTuple):
    """Worst element of one field: ratio of error to tolerance (passes if <= 1)."""

    field: str
    ratio: float
    index: tuple
    reference: float
    got: float


def stage_function(name, backend):
    """Return the public function of stage ``name`` in `melt.<backend>`."""
    return getattr(importlib.import_module(f"melt.{backend}.{STAGES[name].file}"), name)


def poisoned(array):
    """Return an array like ``array`` full of NaN, or of a sentinel for integers."""
    return np.full_like(array, np.nan if array.dtype.kind == "f" else SENTINEL)


class InputChanged(AssertionError):
    """A stage wrote to an array that the registry does not list under its writes."""


@contextlib.contextmanager
def _where(backend):
    """Let CUDA kernels run emulated for the backend ``cuda-emulated``; others keep what is set."""
    before = _compile.Kernel.emulated
    if backend == "cuda-emulated":
        _compile.Kernel.emulated = True
    elif backend == "cuda-simulated":
        _compile.Kernel.emulated = False
    try:
        yield backend.startswith("cuda") and not _compile.Kernel.emulated
    finally:
        _compile.Kernel.emulated = before


def run_stage(name, backend, arrays, params, function=None):
    """Run a stage on copies of ``arrays`` and return its outputs by name.

    Args:
        backend: ``reference``, ``cpu``, ``cuda`` (where `Kernel.emulated` says), ``cuda-emulated``
            or ``cuda-simulated`` (in a process of its own).
        arrays: every field of the stage; outputs give shape and dtype, and the start value where
            the stage also reads them or writes a subset.
        params: the stage's parameters by name.
        function: run this instead of the stage's own function (planted faults).

    Raises:
        InputChanged: the stage wrote to one of its inputs.
    """
    stage = STAGES[name]
    given = {}
    for field in stage.arguments:
        if field in stage.params:
            given[field] = params[field]
            continue
        keep = field not in stage.writes or field in stage.reads or stage.partial
        given[field] = arrays[field].copy() if keep else poisoned(arrays[field])
    function = function or stage_function(name, backend.split("-")[0])
    with _where(backend) as on_device:
        if on_device:
            there = {
                k: _compile.cuda.to_device(v) if isinstance(v, np.ndarray) else v for k, v in given.items()
            }
            function(*(there[a] for a in stage.arguments))
            given.update({k: v.copy_to_host() for k, v in there.items() if k not in stage.params})
        else:
            function(*(given[a] for a in stage.arguments))
    for field in stage.reads:
        if field not in stage.writes and given[field].tobytes() != arrays[field].tobytes():
            raise InputChanged(
                f"stage {name} on {backend}: wrote to {field}, which the registry does not list"
            )
    return {field: given[field] for field in stage.writes if field not in stage.scratch}


def meaning(field, outputs):
    """Return a mask of the elements of an output that mean anything, or None for all.

    A list of particles means nothing behind its count. A neighbour row means nothing behind its count, and
    nothing at all if it overflowed: the host grows the lists and has them built again.
    """
    listed = field.removesuffix("index") + "count"  # active_index and active_count, index and count
    if not field.endswith("index") or listed not in outputs:
        return None
    if outputs[field].ndim == 1:
        return np.arange(outputs[field].shape[0]) < outputs[listed][0]
    count, capacity = outputs[listed], outputs[field].shape[1]
    used = np.arange(capacity)[None, :] < count[:, None]
    return used & (count[:, None] <= capacity)


def unwritten(name, field, array, mask=None):
    """Return whether a poisoned output still holds poison where the stage must have written."""
    if STAGES[name].partial or array.size == 0:
        return False
    poison = np.isnan(array) if array.dtype.kind == "f" else array == SENTINEL
    return bool((poison if mask is None else poison & mask).any())


def difference(name, field, reference, got, precision, scales):
    """Return the worst `Difference` of ``got`` from ``reference`` in one field of a stage.

    A NaN on one side only, or a differing integer, has ratio infinity.
    """
    rtol, atol = STAGES[name].tolerance.of(precision)
    ref = np.asarray(reference, dtype=np.float64)
    new = np.asarray(got, dtype=np.float64)
    if ref.size == 0:
        return Difference(field, 0.0, (), 0.0, 0.0)
    scale = scales.get(FIELDS[field].scale, 1.0) if field in FIELDS else 1.0
    same = (ref == new) | (np.isnan(ref) & np.isnan(new))
    with np.errstate(invalid="ignore", divide="ignore"):  # capacities may be infinite
        allowed = rtol * np.abs(ref) + atol * scale
        if np.asarray(got).dtype.kind in "iu":
            allowed = np.zeros_like(ref)
        ratio = np.where(same, 0.0, np.abs(ref - new) / allowed)
    ratio = np.where(np.isnan(ratio), np.inf, ratio)
    worst = np.unravel_index(np.argmax(ratio), ratio.shape)
    return Difference(
        field, float(ratio[worst]), tuple(int(w) for w in worst), float(ref[worst]), float(new[worst])
    )


def compare_outputs(name, first, second, precision, scales):
    """Return {field: worst `Difference`} of the outputs ``second`` from ``first``.

    Poison left in either is an infinite difference, even if it is left in both.
    """
    found = {}
    for field, ref in first.items():
        got, mask = second[field], meaning(field, first)
        if mask is not None:
            ref, got = np.where(mask, ref, 0), np.where(mask, got, 0)
        worst = difference(name, field, ref, got, precision, scales)
        if unwritten(name, field, first[field], mask) or unwritten(name, field, second[field], mask):
            worst = worst._replace(ratio=np.inf)
        found[field] = worst
    return found


def compare_stage(name, backends, arrays, params, precision, scales):
    """Return {field: worst `Difference`} of ``backends[1]`` from ``backends[0]``."""
    first, second = (run_stage(name, b, arrays, params) for b in backends)
    return compare_outputs(name, first, second, precision, scales)
