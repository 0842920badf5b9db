"""Floods against measurements: flumes, wave basins, a town.

Gauges and run-up of laboratory cases (CADAM sill, NTHMP benchmarks 4, 6 and 7) and surveyed marks of the Merewether
flood, simulated with the shipped scenes. "Finite volumes" are a first-order solver on the case's own grid, the bar to
be under. Cases whose data are not there are left out (MELT_DATA). Run-up is the highest bed under a column: it is
short by up to half a spacing times the slope. These are long waves, without dispersion: a solitary wave steepens
early, and the short waves on top of a measured crest are not there.
"""

import h5py

from experiments import _flood_measured as cases
from experiments._flood_measured_rows import all_rows

CASES = {
    "sill": cases.sill,
    "beach": lambda quick: cases.beach(None, quick),
    "beach_breaking": lambda quick: cases.beach("breaking", quick),
    "monai": cases.monai,
    "island_A": lambda quick: cases.island("A", quick),
    "island_B": lambda quick: cases.island("B", quick),
    "island_C": lambda quick: cases.island("C", quick),
    "merewether": cases.merewether,
}


def run(out, quick=False, say=print, only=None):
    """Run all cases, or those named in ``only``; ``quick``: coarse and short, nothing is judged."""
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for name in only or CASES:
            case = CASES[name](quick)
            if case is None:
                say(f"{name}: its data are not there (set MELT_DATA)")
                continue
            _write(file.create_group(name), case)
            made = case.facts
            say(f"{name}: {made['columns']:,} columns, {made['steps']:,} sub-steps, {made['seconds']:.0f} s")


def _write(group, case):
    group.attrs.update(case.facts)
    for kind in ("gauges", "measured"):
        for name, (t, y) in getattr(case, kind).items():
            group[f"{kind}/{name}"] = [t, y]
    for name, values in case.curves.items():
        group[f"curves/{name}"] = values


def report(path):
    """Return the rows; those of a quick run claim nothing."""
    with h5py.File(path, "r") as file:
        return all_rows(file)
