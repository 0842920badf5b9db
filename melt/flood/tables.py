"""Values over time that a scene gives as a number, a table or a file."""

import numpy as np

from melt.flood.hydrographs import Hydrograph

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0, "day": 86400.0}


def series_of(given, name):
    """Return the `Hydrograph` of a number or of a `melt.scene.flood.Table`.

    Raises:
        InputError: a file that cannot be read or is no table (which line, and what is wrong), times that do not ascend.
    """
    if isinstance(given, float | int):
        return Hydrograph([0.0], [float(given)], name=name)
    if given.table is not None:
        times, values = np.array(given.table, float).reshape(-1, 2).T
        return Hydrograph(times * UNITS[given.time_unit], values * given.scale, after=given.after, name=name)
    read = Hydrograph.read(given.file, given.time_unit, "1", "number", after=given.after)
    return Hydrograph(read.times, read.values * given.scale, after=given.after, name=f"{name} ({given.file})")
