"""Trade-off of kettle_small: one knob at a time, error beside time (boiling spec 7).

The reference run is in double precision with 16 iterations and two sub-steps. Boiling is chaotic, so the error is of what
still has a meaning: compression of the lowest three layers, height of the surface, mean temperature and the share of the
liquid that has boiled, the worst of them as an r.m.s. distance from the reference run over one second.
"""

from experiments._tradeoff import report as report
from experiments._tradeoff import sweep

SCENES = {"kettle_small": 240}


def run(out, quick=False, say=print):
    """Sweep the scene (``quick``: three candidates, 5 steps)."""
    sweep(out, {name: 5 if quick else steps for name, steps in SCENES.items()}, quick, say)
