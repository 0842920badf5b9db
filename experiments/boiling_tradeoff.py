"""Trade-off of kettle_small: one knob at a time, error beside time (boiling spec 7).

The reference run is in double precision with 16 iterations and two sub-steps. Boiling is chaotic, so the errors are of
what still has a meaning: mean compression of the lowest three layers and r.m.s. compression of the top fifth (their own
means), the height of the surface [spacings], the mean temperature [K] and the share of the liquid that has boiled, as r.m.s.
distances from the reference run over one second. A point on a Pareto front is marked with the errors for which no
other point is both faster and better.
"""

from experiments import tradeoff_knobs
from melt import tradeoff_boiling

SCENES = {"kettle_small": 240}


def run(out, quick=False, say=print):
    """Sweep the scene (``quick``: the default and two knobs, 5 steps)."""
    knobs = [("default", "-", []), *tradeoff_boiling.KNOBS[:2]] if quick else None
    tradeoff_knobs.sweep(out, {name: 5 if quick else steps for name, steps in SCENES.items()}, knobs, say)


def report(path):
    """Return one row per point."""
    return tradeoff_knobs.report(path)
