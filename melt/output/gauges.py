"""Readings of the gauges of a flood as a table."""

import csv
import io
import tomllib

from melt.output.errors import RunFileError
from melt.output.run_reader import open_run

COLUMNS = {"surface": "m", "depth": "m", "speed": "m/s"}


def names_of(run):
    """Return the names of the gauges, in the order of the columns of ``run.gauges``."""
    return [gauge.get("name", f"gauge {k}") for k, gauge in enumerate(tomllib.loads(run.scene_text).get("gauge", []))]


def as_csv(path):
    """Return the readings of a run file as CSV, a row per time.

    Raises:
        RunFileError: no run file, or one without gauges.
    """
    with open_run(path) as run:
        if "time" not in run.gauges:
            raise RunFileError(f"{path} has no readings of gauges: the scene needs [[gauge]], and the run one frame")
        names = names_of(run)
        out = io.StringIO()
        table = csv.writer(out, lineterminator="\n")
        table.writerow(["time [s]", *(f"{name} {what} [{unit}]" for name in names for what, unit in COLUMNS.items())])
        for row, time in enumerate(run.gauges["time"]):
            values = (run.gauges[what][row, k] for k in range(len(names)) for what in COLUMNS)
            table.writerow([f"{time:.9g}", *(f"{value:.7g}" for value in values)])
        return out.getvalue()
