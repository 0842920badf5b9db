"""``melt tradeoff SCENE``: run all candidates of a scene, error beside cost."""

import datetime
import os
import pathlib
import time
from typing import NamedTuple

import numpy as np

from melt.dial import measure, report, systems
from melt.dial.front import RULES, on_front, presets_of
from melt.dial.vocabulary import errors_of, headline
from melt.errors import MeltError, SceneError
from melt.forecast import forecast
from melt.geometry.build import build
from melt.output.errors import check_hdf5
from melt.output.provenance import processor, version
from melt.plan import prepare
from melt.scene import find_scene, load_scene
from melt.scene.fronts import Front, FrontPoint, scene_hash, storable, store, stored_front

WITHIN = 120.0  # s of wall time that a whole sweep takes unless given
FEWEST = 20  # outer steps that say anything: rather than fewer, candidates are left out
LEAST = 5  # candidates that are never left out: the scene as it is, and the ends
PATIENCE = 6.0  # times the forecast, or SOON if that is more, that a run may take
SOON = 3.0  # s


class Study(NamedTuple):
    """A sweep: the front to be stored, and the single errors of its points."""

    front: Front
    curves: list  # names of the errors
    errors: list  # {curve: share} by point
    n_sub: list


def run(name, out=None, steps=None, within=None, seeds=2, knobs=None, keep=False, cache=None, say=print):
    """Sweep a scene; print one line per point; write HDF5 and a plot for ``out`` (a .h5 path); ``keep``: store the front.

    ``steps``: outer steps of the scene that each run lasts, as many as fit ``within`` [s] unless given.

    Returns:
        `Study`.
    """
    path, began = find_scene(name), time.perf_counter()
    if out:
        check_hdf5(pathlib.Path(out), "a study")
    for target in ([out] if out else []) + ([storable(path)] if keep else []):
        _check_writable(target)
    scene = load_scene(name)
    system, what = systems.system_of(scene), systems.measure_of(scene)

    def load(overrides):
        return load_scene(name, overrides)

    shared = system.shared(scene)
    knobs = list(knobs or systems.candidates(scene, load))
    reference = [] if what.exact else [*shared, *system.reference(scene)]
    knobs, window, seconds = lay_out(load, knobs, shared, reference, seeds, within or WITHIN, steps)
    facts = facts_of(scene, path, what, reference, window, seeds, bool(system.reseeded(scene, 1)))
    for line in report.opening(scene, facts, len(knobs), sum(seconds.values())):
        say(line)
    truth, left, slower = None, (within or WITHIN) * 1.5, 1.0
    if not what.exact:
        made, kept = _reference(load, reference, window, cache)
        truth, left = made.truth, left - (0.0 if kept else made.seconds)
        say(f"reference: {made.ms_per_step:.2f} ms a step{', kept from an earlier study' if kept else ''}")
    points, errors, n_subs = [], [], []
    for knob in knobs:
        if len(points) >= LEAST and left < 0:
            say(f"{knob.label}: left out, {within or WITHIN:.0f} s are over")
            continue
        patience = PATIENCE * max(slower * seconds[knob.label] / seeds, SOON) if points else np.inf
        point, found, n_sub, spent = measured(load, system, knob, shared, window, truth, what, seeds, patience)
        left -= spent
        if not points:  # the forecast is of free cores, and of this scene it may be wrong
            slower = max(1.0, spent / max(seconds[knob.label], 1e-9))
        points, errors, n_subs = [*points, point], [*errors, found], [*n_subs, n_sub]
        say(report.line(point, found))
    points = chosen(points)
    facts["took"] = f"{time.perf_counter() - began:.0f} s"
    study = Study(Front(facts, points), _names(errors), errors, n_subs)
    for line in report.closing(study.front):
        say(line)
    if keep:
        say(f"stored {store(study.front, path)}")
    if out:
        report.write(study, out)
        report.plot(study, pathlib.Path(out).with_suffix(".png"))
    return study


def _reference(load, overrides, window, cache):
    """Return what `measure.reference_run` does; what stops it is told from what stops the scene as it is."""
    try:
        return measure.reference_run(load, overrides, window, cache)
    except MeltError as error:
        raise MeltError(f"the run that all others are compared with ({'; '.join(overrides)}) does not work: {error}") from error


def _check_writable(target):
    """Raise `MeltError` if a result could not be written: before the runs, not after them."""
    folder = pathlib.Path(target).absolute().parent
    if folder.name == "fronts" and not folder.exists():  # made when the first one is stored
        folder = folder.parent
    older = pathlib.Path(target)
    if not folder.is_dir() or not os.access(folder, os.W_OK) or older.is_dir() or (older.exists() and not os.access(older, os.W_OK)):
        raise MeltError(f"{target} cannot be written: give a file in a folder of yours (a scene's front is stored beside it)")


def _names(errors):
    return list(dict.fromkeys(name for found in errors for name in found))


def chosen(points):
    """Return the points with those on the front marked, and the presets named."""
    front, named = set(on_front(points)), presets_of(points)
    return [
        p._replace(on_front=i in front, presets=tuple(name for name, index in named.items() if index == i))
        for i, p in enumerate(points)
    ]


def lay_out(load, knobs, shared, reference, seeds, within, steps=None):
    """Return (candidates that fit, simulated seconds of each run, {label: forecast of its repetitions [s]}).

    The dearest question is how long a run may be: as long as ``within`` allows by the forecast, but not below `FEWEST` outer
    steps; rather than that the last candidates go.
    """
    default = load(shared)
    initial = build(default)
    rates = {k.label: seeds * _rate(load([*shared, *k.overrides]), initial if _numerical(k) else None) for k in knobs}
    first = _rate(load(reference)) if reference else 0.0
    longest = default.time.end
    shortest = min(max(FEWEST * default.time.dt, systems.system_of(default).shortest(default)), longest)
    kept = list(knobs)
    while steps is None and len(kept) > LEAST and shortest * (first + sum(rates[k.label] for k in kept)) > within:
        kept.pop()
    total = first + sum(rates[k.label] for k in kept)
    window = steps * default.time.dt if steps else min(longest, max(shortest, within / max(total, 1e-300)))
    window = max(1, int(window / default.time.dt + 1e-6)) * default.time.dt
    return kept, window, {k.label: window * rates[k.label] for k in kept} | {"reference": window * first}


def _numerical(knob):
    """Return whether a candidate starts from the arrays of the scene as it is."""
    parts = ("solver.", "time.", "heat.", "viscosity.")
    return all(o.startswith(parts) and not o.startswith(("solver.apic", "solver.ghosts")) for o in knob.overrides)


def _rate(scene, initial=None):
    """Return the forecast of the wall seconds per simulated second; 0 of what cannot start, which its own run will tell."""
    try:
        initial = initial or build(scene)
        return forecast(scene, initial, prepare(scene, initial), 1).seconds / scene.time.dt
    except MeltError:
        return 0.0


def measured(load, system, knob, shared, window, truth, what, seeds, patience):
    """Run one candidate over the seeds; return (`FrontPoint`, {curve: share}, sub-steps of the last step, wall seconds)."""
    overrides, spent, each, samples = [*shared, *knob.overrides], 0.0, [], []
    try:
        for k in range(seeds):
            # of what this candidate has: a seed brings back what it has taken out
            reseeded = system.reseeded(load(overrides), k) if k else []
            made = measure.sample(load([*overrides, *reseeded]), window, k, patience)
            spent += made.seconds
            samples.append(made)
            each.append(errors_of(made.times, made.curves, truth, what))
    except MeltError as error:
        slow = isinstance(error, measure.TooSlow)
        spent += patience if slow else 0.0
        why = "too slow" if slow else "refused" if isinstance(error, SceneError) else "unstable"
        failed = FrontPoint(knob.label, tuple(knob.overrides), np.nan, np.nan, 0, np.nan, np.nan, failure=f"{why}: {error}")
        return failed, {}, 0, spent
    heads = 100 * np.array([headline(errors) for errors in each])
    spread = float(np.ptp(heads) / 2) if seeds > 1 else np.nan
    fastest = min(samples, key=lambda s: s.ms_per_step)
    # the digits that are stored: ranks of a stored front are then those of its file
    figures = [float(f"{x:.4g}") for x in (fastest.ms_per_step, fastest.s_per_simulated_s, heads.mean(), spread)]
    point = FrontPoint(knob.label, tuple(knob.overrides), *figures[:2], fastest.bytes, *figures[2:])
    mean = {name: float(np.mean([errors[name] for errors in each if name in errors])) for name in each[0]}
    return point, mean, samples[-1].n_sub, spent


def facts_of(scene, path, what, reference, window, seeds, random):
    """Return the facts that go with a front."""
    repeated = f"the liquid displaced by {measure.SHAKE:g} of a spacing at most" + (", another random seed" if random else "")
    return {
        "scene": path.stem,
        "error": what.words,
        "reference": "exact solution" if what.exact else "; ".join(reference),
        "steps": round(window / scene.time.dt),
        "simulated": f"{window:g} s",
        "seeds": f"{seeds}, {repeated}" if seeds > 1 else "1, no spread",
        "presets": RULES,
        "date": datetime.date.today().isoformat(),
        "version": version("melt"),
        "machine": f"{processor()}, {os.cpu_count()} cores, CPU backend",
        "scene hash": scene_hash(path),
        "source hash": measure.source_hash(),
    }


def fresh(path):
    """Return whether the stored front of a scene file was measured with this source and this scene."""
    front = stored_front(path)
    if front is None:
        return False
    return front.facts.get("scene hash") == scene_hash(path) and front.facts.get("source hash") == measure.source_hash()


def run_all(paths, options):
    """Sweep the scenes of {name: path} that have no fresh front; return the names of those that failed."""
    say, failed = options["say"], []
    for path in paths.values() if options["keep"] else ():  # before the first scene, not after each
        storable(path)
    for name, path in paths.items():
        if options["keep"] and fresh(path):
            say(f"{name}: its front is fresh")
            continue
        try:
            run(name, **options)
        except MeltError as error:
            say(f"{name}: {error}")
            failed.append(name)
    return failed
