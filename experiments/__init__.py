"""Experiments: one module per paper table or figure, per validation family, per stability map.

A module has a docstring (what is claimed, by whom), and two functions:

``run(out, quick=False, say=print)``  simulate and write an HDF5 file ``out``
``report(path)``                      read that file only and return a list of `Row`

``python -m experiments`` runs all of them and writes ``docs/results.md``; ``melt reproduce NAME`` runs one.
A miss stays in the table, marked. Small versions (``quick``) claim nothing.
"""

import importlib
import pkgutil
from typing import NamedTuple


class Row(NamedTuple):
    """One line of a results table."""

    name: str  # what was measured
    expected: str  # the paper's, the experiment's or the analytic value
    measured: str
    bound: str  # tolerance or target; "" where nothing is claimed
    ok: bool | None  # None: no claim
    note: str = ""


def claiming(rows, quick):
    """Return the rows of a report; small versions (``quick``) show that it runs, and claim nothing."""
    return [row._replace(bound="", ok=None) for row in rows] if quick else rows


def names():
    """Return the names of all experiments, as ``melt reproduce`` spells them."""
    return sorted(m.name.replace("_", "-") for m in pkgutil.iter_modules(__path__) if not m.name.startswith("_"))


def load(name):
    """Return the module of the experiment called ``name``."""
    return importlib.import_module(f"{__name__}.{name.replace('-', '_')}")
