"""Flood: exact solutions of the shallow water equations (dam breaks, bowls, lakes at rest, steady flows, a circular dam).

Strip and basin flows with solutions in closed form, at the resolutions and bounds of the specification, beside a
finite-volume solver (HLL, first and second order) on cells as wide as the columns are apart. L1 is sum A |d - d_exact| over
sum A d_exact: at the columns, and on a grid of the spacing where depths are conservative sums of the columns. Velocities are
weighed by mass. Double precision, kernel and layout of the scene unless a row says otherwise; tables of forms, supports, their
limit, stabilisation and layouts claim nothing.
"""

import h5py
import numpy as np

from experiments import _flood_cases as cases
from experiments import _flood_steady as flows
from experiments import _flood_still as still
from experiments._flood_analytic_rows import all_rows

#: Table -> (dam, {name: settings}), all at r0 = 0.1 m.
TABLES = {
    "form": ("ritter", {f: (f"solver.form={f}",) for f in ("variational", "symmetric", "balanced", "linear")}),
    "form, wet": ("stoker", {f: (f"solver.form={f}",) for f in ("variational", "symmetric", "balanced", "linear")}),
    "largest support": ("ritter", {f"{k:g} h0": (f"solver.support_limits=[0.25, {k}]",) for k in (1.5, 2.0, 3.0, 5.0, 20.0)}),
    "alpha": ("stoker", {f"{a:g}": (f"solver.alpha={a}", "time.n_sub_max=400") for a in (0.0, 0.25, 0.5, 1.0, 2.0)}),
    "layout": ("ritter", {k: (f"fluid.layout={k}",) for k in ("equal_mass", "hexagonal", "lattice")}),
    "layout, wet": ("stoker", {k: (f"fluid.layout={k}",) for k in ("equal_area", "equal_mass", "hexagonal", "lattice")}),
    "kernel, wet": ("stoker", {f"{k} {s:g}": (f"solver.kernel={k}", f"solver.support={s}")
                               for k, s in (("cubic", 2.3), ("cubic", 2.66), ("wendland2", 2.66), ("wendland2", 3.2))}),
}


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: small and short, nothing is judged."""
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        keep = _Keeper(file, say)
        for case in (_dams, _tables, _bowls, _lakes, _steady, _circle):
            case(keep, quick)


class _Keeper:
    """Writes figures by name, and says them; a case that fails is kept by its message."""

    def __init__(self, file, say):
        self.file, self.say = file, say

    def __call__(self, name, case, *arguments, **options):
        try:
            values = case(*arguments, **options)
        except Exception as error:
            values = {"failed": f"{type(error).__name__}: {error}"[:300]}
        group = self.file.create_group(name)
        for key, value in values.items():
            if isinstance(value, np.ndarray):
                group[key] = value
            else:
                group.attrs[key] = value
        self.say(f"{name}: " + ", ".join(f"{k} {_short(v)}" for k, v in values.items() if not isinstance(v, np.ndarray)))


def _short(value):
    return f"{value:.4g}" if isinstance(value, (float, np.floating)) else str(value)


def _dams(keep, quick):
    for name in cases.DAMS:
        for spacing in (0.25,) if quick else (0.2, 0.1, 0.05):
            keep(f"dam/{name}/{spacing:g}", cases.dam, name, spacing)
            for order in (1, 2):
                keep(f"volumes/{name}/{order} {spacing:g}", cases.dam_volumes, name, spacing, order)


def _tables(keep, quick):
    for table, (name, settings) in TABLES.items():
        for value, given in list(settings.items())[:1] if quick else settings.items():
            keep(f"table/{table}/{value}", cases.dam, name, 0.25 if quick else 0.1, *given)


def _bowls(keep, quick):
    spacing, periods = (0.08, 0.1) if quick else (0.025, 3)
    for kind in cases.BOWLS:
        keep(f"bowl/{kind}/alpha 1", cases.bowl, kind, spacing, periods)
        keep(f"bowl/{kind}/alpha 0.25", cases.bowl, kind, spacing, periods, "solver.alpha=0.25")
        keep(f"bowl volumes/{kind}", cases.bowl_volumes, kind, 0.1 if quick else 0.025, periods)


def _lakes(keep, quick):
    spacing, settle, seconds = (0.4, 1.0, 0.2) if quick else (0.2, 200.0, 2.0)
    for bed in still.BEDS:
        keep(f"lake/{bed}", still.lake, bed, spacing, settle, seconds=seconds)
        keep(f"lake/{bed}, hard edges", still.lake, bed, spacing, settle, seconds=seconds, walls=False)
    for bed in ("smooth bump", "kinked bump"):
        keep(f"exact lake/{bed}", still.exact_lake, bed, 0.4 if quick else 0.1, 2 if quick else 50)


#: Steady case -> (spacing [m], end [s]).
STEADY = {"subcritical": (0.2, 40.0), "transcritical": (0.2, 60.0), "jump": (0.1, 80.0), "macdonald": (0.5, 200.0)}


def _steady(keep, quick):
    for case, (spacing, end) in STEADY.items():
        size, stop = (8 * spacing if case == "macdonald" else 0.5, 1.0) if quick else (spacing, end)
        keep(f"steady/{case}", flows.steady, case, f"fluid.spacing={size}", end=stop)
        keep(f"steady volumes/{case}", flows.steady_volumes, case, size, end=stop if quick else None)
    keep("leaving", flows.leaving_wave, spacing=0.4 if quick else 0.1)


def _circle(keep, quick):
    for kernel in ("cubic", "wendland2"):
        keep(f"circle/{kernel}", cases.circle, 0.25 if quick else 0.1, f"solver.kernel={kernel}")


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        return all_rows(file)
