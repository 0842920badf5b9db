"""Trade-off of floods: parabolic_bowl and monai, one knob at a time, error beside time (flood spec 8)

The bowl has an exact solution: its error is that of the depth at the columns, L1, mean over the run (1.2 s, a quarter of a
period). Of the Monai valley the first 5 s, before its wave breaks: centre, spread, motion and gauges are compared with a run
of half the spacing in double precision. Milliseconds are those of an outer step of several sub-steps.
"""

from experiments._flood_data import monai
from experiments._tradeoff import report as report
from experiments._tradeoff import sweep

SCENES = {"parabolic_bowl": 60, "monai": 100}


def run(out, quick=False, say=print):
    """Sweep the scenes (``quick``: the bowl, three candidates, 5 steps); monai only where its data are."""
    scenes = {name: 5 if quick else steps for name, steps in SCENES.items()}
    if quick or monai() is None:
        scenes.pop("monai")
    sweep(out, scenes, quick, say)
