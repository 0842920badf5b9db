"""Run the maps of a scene, cell by cell; what is finished is kept if the sweep is killed, and not run again."""

import numpy as np

from melt.atlas import store
from melt.atlas.alarms import FAILED, NOISY, REFUSED, STABLE, fall_of
from melt.atlas.maps import chosen
from melt.atlas.rows import rows_of
from melt.atlas.search import factor_of, search
from melt.atlas.store import Cell
from melt.errors import MeltError
from melt.scene import load_scene
from melt.simulation import Simulation

LEAST = 30  # steps of a run at least, where a span would be fewer
LOOKS = 12  # times that a run is looked at


def run(name, out=None, maps=None, overrides=(), rows=None, steps=None, overwrite=False, say=print, picture=True):
    """Sweep the maps of a scene; write HDF5, and a ``picture`` beside it, if ``out`` (a .h5 path) is given.

    Args:
        maps: names; all that apply to the scene unless given.
        rows: values of the second knob in each map; the map's own number unless given.
        steps: of each run at most; likewise.

    Returns:
        {map: list of `Cell`}.

    Raises:
        MeltError: unknown scene or map, or a file that is of another sweep.
    """
    scene = load_scene(name, overrides)
    plan = chosen(scene, maps)
    kept = store.Kept(out, scene, rows, steps, overwrite)
    found = {}
    try:
        for m in plan:
            say(f"{scene.scene.name}: {m.words} x {m.along.words}; predicted: {m.predicted}")
            cells = found[m.name] = kept.cells(m)
            if cells:
                say(f"  {len(cells)} runs are in {kept.part} from an earlier sweep")
            for row, value in enumerate(m.along.values(rows or m.rows)):
                _row(name, m, row, value, steps or m.steps, overrides, cells, lambda m=m, cells=cells: kept.save(m, cells), say)
        kept.finish(plan)
    finally:
        kept.close(say)
    if out and picture:
        from melt.atlas.plot import plot

        say(f"wrote {out} and {plot([out], store.picture(out), scene.scene.name)}")
    return found


def _row(name, m, row, value, steps, overrides, cells, save, say):
    """Search one row; cells that are there are not run again."""
    known = {c.k: c for c in cells if c.row == row}

    def grade(k):
        if k not in known:
            known[k] = measure(name, m, row, k, value, steps, overrides)
            cells.append(known[k])
            save()
        return known[k].grade

    search(grade, m.octaves, m.octaves // 2)
    (found,) = rows_of([c for c in cells if c.row == row], {"bound": m.bound, "octaves": m.octaves})
    why = f"; then {found.first.grade}: {found.first.reason}"[:110] if found.first else ""
    whole = "" if found.whole is None else f", whole to {found.whole:.3g} x"
    stable = found.words if found.stable is None else f"stable to {found.words} the bound ({found.governing})"
    say(f"  {m.along.words} {value:.3g} {m.along.unit}: {stable}{whole}{why}")


def measure(name, m, row, k, value, steps, overrides=()):
    """Return the `Cell` of one run."""
    x, factor = m.bound * factor_of(k), factor_of(k)
    more = [*m.base, *m.along.overrides(value)]
    if m.across is not None:
        more, factor = more + m.across.overrides(x), 1.0
    try:
        sim = Simulation(load_scene(name, [*overrides, *more]), "cpu")
    except MeltError as error:
        return Cell(row, k, value, x, REFUSED, str(error), 0, 0, "", np.inf)
    result = graded(sim, m, factor, steps)
    taken = result.pop("times")
    return Cell(row, k, value, x if m.across is not None else float(np.mean(taken) if taken else np.nan), **result, steps=len(taken))


def graded(sim, m, factor, steps):
    """Step a simulation; return what `Cell` says of it, and the ``times`` of its steps [s]."""
    fall = fall_of(sim)
    times, bound, worst, found = [], "", 0.0, (STABLE, "", 0)
    look = max(1, steps // LOOKS)
    while len(times) < steps:
        try:
            dt, governing = m.drive(sim, factor)
        except MeltError as error:
            found = FAILED, str(error), len(times) + 1
            worst = np.inf
            break
        times.append(dt)
        bound = bound or governing
        last = len(times) == steps or (len(times) >= LEAST and m.span > 0 and sum(times) >= m.span * fall.time)
        if last or len(times) % look == 0:
            for alarm, size in _figures(sim, m, fall):
                worst = max(worst, size / alarm.noisy)
                grade = FAILED if not size <= alarm.failed else NOISY if size > alarm.noisy else STABLE
                if grade == FAILED or (grade == NOISY and found[0] == STABLE):
                    found = grade, f"{alarm.words} {size:.3g}, limit {alarm.failed if grade == FAILED else alarm.noisy:g}", len(times)
                    if grade == FAILED:
                        break
        if last or found[0] == FAILED:
            break
    grade, reason, step = found
    return dict(grade=grade, reason=reason, step=step or len(times), bound=bound, worst=float(worst), times=times)


def _figures(sim, m, fall):
    """Return [(alarm, its figure)] of now; what is not a number is infinite."""
    series = sim.series()
    sizes = [(alarm, alarm.value(sim, series, fall)) for alarm in m.alarms]
    return [(alarm, size if size == size else np.inf) for alarm, size in sizes]
