"""Trade-off of incompressible liquids: dam_break_dfsph and honey_coil_small, one knob at a time, error beside time (slime spec 8)

Errors are distances to a run of half the sub-step with tight solves in double precision, root mean square over the run, of the
worst curve: height of the centre of mass, front of the dam break, and of the folding sheet the sideways position of its centre
(axis) and its lowest 2 % (tip), mean compression. Its nozzle is brought near the plate, so that most of 0.8 s are on it.
"""

from experiments import tradeoff_knobs

SCENES = {"dam_break_dfsph": 115, "honey_coil_small": 400}


def run(out, quick=False, say=print):
    """Sweep both scenes (``quick``: the dam break, three candidates, 3 steps)."""
    tradeoff_knobs.sweep(out, {"dam_break_dfsph": 3} if quick else SCENES, quick, say)


def report(path):
    """Return one row per point."""
    return tradeoff_knobs.report(path)
