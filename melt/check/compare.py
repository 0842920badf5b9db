"""Run one stage on one backend with poisoned outputs, and measure the difference of two runs."""

import importlib
from typing import NamedTuple

import numpy as np

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


def run_stage(name, backend, arrays, params):
    """Run a stage on copies of ``arrays`` and return its outputs by name.

    ``arrays`` holds every field of the stage (outputs give shape and dtype, and the start
    value where the stage also reads them or writes a subset); ``params`` its parameters.
    """
    stage = STAGES[name]
    given = {}
    for field in stage.arguments:
        if field in stage.params:
            given[field] = params[field]
            continue
        keep = field not in stage.writes or field in stage.reads or stage.partial
        given[field] = arrays[field].copy() if keep else poisoned(arrays[field])
    stage_function(name, backend)(*(given[a] for a in stage.arguments))
    return {field: given[field] for field in stage.writes if field not in stage.scratch}


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
    allowed = rtol * np.abs(ref) + atol * scale
    if np.asarray(got).dtype.kind in "iu":
        allowed = np.zeros_like(ref)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.where(same, 0.0, np.abs(ref - new) / allowed)
    ratio = np.where(np.isnan(ratio), np.inf, ratio)
    worst = np.unravel_index(np.argmax(ratio), ratio.shape)
    return Difference(field, float(ratio[worst]), tuple(int(w) for w in worst), float(ref[worst]), float(new[worst]))


def compare_stage(name, backends, arrays, params, precision, scales):
    """Return {field: worst `Difference`} of ``backends[1]`` from ``backends[0]``."""
    first, second = (run_stage(name, b, arrays, params) for b in backends)
    return {f: difference(name, f, first[f], second[f], precision, scales) for f in first}
