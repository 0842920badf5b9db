"""Only what a scene requires: milliseconds of every shipped scene, and of the same scene with everything switched on

Median of 5 outer steps after 2, from the start of the scene, all threads, in the scene's own precision. Counts of stages and
fields and bytes are those of docs/scenes.md. "Everything" is what its system offers and the scene may have (`melt/costs.py`); it
costs more sub-steps, too, where a bound of the time step asks for them. What does not run with everything on says so.
"""

import pathlib
import time

import h5py
import numpy as np

from experiments import Row

STEPS, WARM = 5, 2
QUICK = ("tank_small", "couette")


def run(out, quick=False, say=print):
    """Time all shipped scenes (``quick``: two small ones)."""
    from melt import costs
    from melt.scene import load_scene
    from melt.scene.load import shipped_scenes

    with h5py.File(out, "w") as file:
        for name in QUICK if quick else shipped_scenes():
            if not costs.has_data(load_scene(name)):
                say(f"{name}: its measured terrain is not here (MELT_DATA)")
                continue
            group = file.create_group(name)
            for which, overrides in (("own", []), ("full", costs.everything_of(name))):
                group.create_group(which).attrs.update(timed(load_scene(name, overrides)), overrides=", ".join(overrides))
            own, full = (group[w].attrs["ms"] for w in ("own", "full"))
            say(f"{name}: {own:.2f} ms per step, with everything {full:.2f}")


def timed(scene):
    """Return figures of a scene: ms per outer step, sub-steps, counts, and why it failed, if it did."""
    from melt import costs
    from melt.errors import MeltError
    from melt.simulation import Simulation

    cost, spent, failure, n_sub = costs.cost_of(scene), [], "", 0
    try:
        sim = Simulation(scene, "cpu")
        for _ in range(WARM + STEPS):
            began = time.perf_counter()
            sim.step()
            spent.append(1e3 * (time.perf_counter() - began))
        n_sub = int(sim.do.notes.get("n_sub", 1))
    except MeltError as error:
        failure = str(error)
    ms = float(np.median(spent[WARM:])) if len(spent) > WARM and not failure else np.nan
    figures = dict(particles=cost.particles, stages=cost.stages, fields=cost.fields, bytes=cost.nbytes)
    return dict(ms=ms, n_sub=n_sub, precision=scene.solver.precision, failure=failure, **figures)


def report(path):
    """Return one row per scene."""
    rows = []
    with h5py.File(pathlib.Path(path)) as file:
        for name, group in file.items():
            own, full = group["own"].attrs, group["full"].attrs
            beside = f"everything on: {full['ms']:,.2f} ms at {full['n_sub']} ({full['ms'] / own['ms']:.1f} x)"
            if full["failure"]:
                beside = f"everything on: does not run: {str(full['failure'])[:160]}"
            if own["failure"]:
                beside = f"does not run: {own['failure']}"
            more = f"{own['particles']:,} particles, {own['precision']}; {own['stages']} stages, {own['fields']} fields"
            each = own["bytes"] / max(own["particles"], 1)
            rows.append(Row(
                name, "", f"{own['ms']:,.2f} ms per outer step at {own['n_sub']} sub-step(s)", "", None,
                f"{more}, {each:,.0f} bytes per particle; {beside}",
            ))
    return rows
