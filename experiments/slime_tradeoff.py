"""Trade-off of incompressible liquids: dam_break_dfsph and honey_coil_small, one knob at a time, error beside time (slime spec 8)

Errors are distances to a run of half the sub-step with tight solves in double precision, in spacings, root mean square over the
run: height of the centre of mass, front of the dam break, and of the folding sheet the sideways position of its centre (axis)
and its lowest 2 % (tip); "density error" is the mean compression itself. Its nozzle is brought near the plate, so that most of 0.8 s
are on it. Milliseconds are those of an outer step of n_sub sub-steps. A point
on a Pareto front is marked with the errors for which no other point is both faster and better.
"""

from experiments import tradeoff_knobs

SCENES = {"dam_break_dfsph": None, "honey_coil_small": None}


def run(out, quick=False, say=print):
    """Sweep both scenes (``quick``: the dam break, two knobs, 3 steps)."""
    from melt import tradeoff_slime
    from melt.scene import load_scene

    knobs = tradeoff_slime.knobs_of(load_scene("dam_break_dfsph"))[:3] if quick else None
    tradeoff_knobs.sweep(out, {"dam_break_dfsph": 3} if quick else SCENES, knobs, say)


def report(path):
    """Return one row per point."""
    return tradeoff_knobs.report(path)
