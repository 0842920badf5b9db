"""Trade-off of ice_cube_small and stefan_front_small: one knob at a time, error beside time (spec 7).

The error is the distance to a reference run in double precision with more sub-steps, that of the worst of several curves in
percent (`melt tradeoff`); what the single curves say stands in the note. "front" marks points that no other beats in both
cost and error.
"""

from experiments._tradeoff import report as report
from experiments._tradeoff import sweep

SCENES = {"ice_cube_small": 100, "stefan_front_small": 60}


def run(out, quick=False, say=print):
    """Sweep both scenes (``quick``: three candidates, 5 steps); plots go beside ``out``."""
    sweep(out, {scene: 5 if quick else steps for scene, steps in SCENES.items()}, quick, say)
