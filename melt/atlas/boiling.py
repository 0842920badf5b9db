"""Maps of position based liquids and of heat in them. Boiling spec 2.1, 2.3."""

from melt.atlas import drives
from melt.atlas.alarms import COMPRESSION, ENERGY, OVERSHOOT, SPEED
from melt.atlas.maps import Axis, Map, spread
from melt.boiling import diffusivity_of

#: A tank that does not boil is at rest: bubbles would be the noise.
AT_REST = ["time.n_sub=1", "boiling=none"]


def maps(scene):
    """Return the maps that apply to a scene."""
    found = []
    if scene.solver.pressure == "pbf":
        found.append(_iterations(scene))
    if scene.boiling is not None and scene.boiling.heat_model != "grid" and scene.heat is None:  # else heat conducts as [heat] says
        found.append(_diffusivity(scene))
    return found


def _iterations(scene):
    alarms = (ENERGY, SPEED, COMPRESSION._replace(noisy=scene.solver.pbf.compression))
    knob = Axis("iterations", "", lambda v: [f"solver.pbf.iterations={max(1, round(v))}"], _whole)
    predicted = f"compression of {scene.solver.pbf.compression:.1%} at the bottom, or half a spacing"
    return Map("dt-iterations", knob, drives.mechanics, alarms, AT_REST, 4.0, predicted, octaves=5)


def _whole(number):
    return [2.0**k for k in range(number)]


def _diffusivity(scene):
    alpha = diffusivity_of(scene)
    knob = Axis("thermal diffusivity", "m^2/s", lambda v: [f"boiling.diffusivity={v!r}"], spread(0.01 * alpha, 100 * alpha))
    predicted = "1/max sum of exchange rates: no temperature leaves its range"
    return Map("dt-diffusivity", knob, drives.liquid_conduction, (OVERSHOOT,), [], 0.0, predicted, rows=3, steps=40)
