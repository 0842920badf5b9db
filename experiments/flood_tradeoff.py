"""Trade-off of floods: parabolic_bowl and monai, one knob at a time, error beside time (flood spec 8)

The bowl has an exact solution: "exact L1(d)" is the error of the depth at the columns, mean over the run (1.2 s, a quarter of
a period). Centre, spread [m] and gauges [m] are compared with a run of half the spacing in double precision; of the Monai
valley the first 5 s, before its wave breaks. A point on a Pareto front is marked with the errors for which no other point
is both faster and better. Milliseconds are those of an outer step of several sub-steps.
"""

from experiments import tradeoff_knobs
from experiments._flood_data import monai

SCENES = {"parabolic_bowl": 60, "monai": 100}


def run(out, quick=False, say=print):
    """Sweep the scenes (``quick``: the bowl, the default and two knobs, 5 steps); monai only where its data are."""
    from melt import tradeoff_flood

    knobs = [("default", "-", []), *tradeoff_flood.KNOBS[:2]] if quick else None
    scenes = {name: 5 if quick else steps for name, steps in SCENES.items()}
    if quick or monai() is None:
        scenes.pop("monai")
    tradeoff_knobs.sweep(out, scenes, knobs, say)


def report(path):
    """Return one row per point."""
    return tradeoff_knobs.report(path)
