"""How long a run will take on CPU, before it runs: launches, particles and heat, each with its measured cost."""

import math
from typing import NamedTuple

from melt.flood.findings import seconds_per_step
from melt.slime.cost import seconds_per_sub_step
from melt.systems.heat import chosen_solver, thermal_substeps

#: Seconds, measured on two cores (small scenes of 2 000 to 14 000 particles, ice_cube of 69 000), mixed precision.
LAUNCH = 40e-6  # of a stage: Python, waking the threads, a share of the frames; rules below 10^4 particles
MOBILE, WALL = 0.45e-6, 0.05e-6  # of a particle and sub-step: walls have no lists
PRECISION = {"single": 0.8, "mixed": 1.0, "double": 1.3}
#: Of a thermal sub-step: what it costs whatever its size (pairs_coloured: 36 launches, one per colour and sweep), and per
#: mobile particle.
HEAT = {
    "pairs_coloured": (4.5e-3, 0.10e-6),
    "pairs_seq": (0.1e-3, 1.0e-6),
    "onesided": (0.3e-3, 0.40e-6),
    "explicit": (0.3e-3, 0.20e-6),
    "cg": (2.0e-3, 1.0e-6),
}


class Forecast(NamedTuple):
    """Wall time of a run on two cores after compiling, and where it goes [s]."""

    seconds: float
    mechanics: float
    heat: float
    steps: int
    sub_steps: int

    @property
    def text(self):
        """The forecast in words."""
        parts = [f"{self.sub_steps} sub-step{'s' * (self.sub_steps > 1)} each"] if self.sub_steps else []
        if self.heat > 0.4 * self.seconds:
            parts.append(f"heat {self.heat / self.seconds:.0%} of it")
        if self.mechanics > 0.4 * self.seconds and self.sub_steps > 8:
            parts.append("small sub-steps make it slow: see the time step bounds of melt plan")
        where = f" ({', '.join(parts)})" if parts else ""
        return f"after compiling, about {in_words(self.seconds)} on 2 free cores{where}"


def forecast(scene, initial, prepared, steps=None):
    """Return the `Forecast` of ``steps`` outer steps (all of the scene's unless given) on two CPU cores."""
    from melt.preflight import limits

    steps = scene.time.steps if steps is None else steps
    if scene.kind == "flood":
        n_sub, seconds = seconds_per_step(scene, initial, prepared)
        return Forecast(steps * seconds, steps * seconds, 0.0, steps, n_sub)
    counts, settings = initial.counts, prepared.settings
    walls = counts["wall"]
    # an inflow fills its slots in the course of the run: half of them on average
    mobile = counts["liquid"] + counts["solid"] + 0.5 * counts.get("inactive", 0)
    slower = PRECISION[prepared.precision]
    sub_steps, mechanics, heat = 0, 0.0, 0.0
    if scene.solver.motion:
        sub_steps = settings.n_sub or max(1, math.ceil(scene.time.dt / min(limits(prepared).values()) * (1 - 1e-9)))
        mechanics = sub_steps * (LAUNCH * len(prepared.stages) + slower * (MOBILE * mobile + WALL * walls))
        if prepared.need.incompressible:
            more, launches = seconds_per_sub_step(scene, prepared, mobile)
            mechanics += sub_steps * (LAUNCH * launches + slower * more)
    if prepared.need.heat:
        fixed, each = HEAT[chosen_solver(settings)]
        heat = thermal_substeps(settings) * (fixed + slower * each * mobile)
    return Forecast(steps * (mechanics + heat), steps * mechanics, steps * heat, steps, sub_steps)


def in_words(seconds):
    """Return a duration in words: two digits are more than a forecast knows."""
    if seconds < 1:
        return "1 s"
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.0f} h"
