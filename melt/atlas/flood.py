"""Maps of floods: time step over stabilisation, over the depth ratio of a dam break, over slope; slope over depth. Flood spec E20."""

from melt.atlas import drives
from melt.atlas.alarms import ENERGY, SPEED, Alarm
from melt.atlas.maps import Axis, Map, spread
from melt.flood.findings import STEEP


def maps(scene):
    """Return the maps that apply to a scene."""
    found = [_stabilisation(scene)]
    deep = [pool.depth for pool in scene.fluid.fill]
    if deep and all(deep):
        found.append(_courant(scene, deep))
    if scene.terrain.shape in ("flat", "plane") and len(deep) == 1 and deep[0]:
        found += [_steps_on_slopes(scene), _slope(scene, deep[0])]
    return found


def _deep(v):
    """Water of one depth with as many columns, whatever it is."""
    return [f"fluid.fill.0.depth={v!r}", f"fluid.reference_depth={v!r}"]


def _unsolved(sim, series, fall):
    return series.get("unsolved_columns", 0.0) / max(1, series["liquid_particles"])


WATER = (ENERGY, SPEED, Alarm("columns whose depth is not solved", _unsolved, 0.01))


def _courant(scene, deep):
    """Of two pools the second has a share of the first one's depth; of one the depth itself is the knob."""
    predicted = f"Courant number {scene.solver.cfl:g}, or force, or terrain"
    if len(deep) > 1:
        knob = Axis("depth ratio", "", lambda v: [f"fluid.fill.1.depth={v * deep[0]!r}"], spread(0.001, 0.5))
        return Map("dt-depth-ratio", knob, drives.shallow_water, WATER, [], 1.0, predicted, octaves=6, steps=80)
    knob = Axis("depth", "m", _deep, spread(0.1 * deep[0], 10 * deep[0]))
    return Map("dt-depth", knob, drives.shallow_water, WATER, [], 1.0, predicted, octaves=6, steps=80)


def _stabilisation(scene):
    """The one thing that damps in the method: more of it bounds the step as viscosity does."""
    knob = Axis("Lax-Friedrichs alpha", "", lambda v: [f"solver.alpha={v!r}"], spread(0.1, 10))
    predicted = f"Courant number {scene.solver.cfl:g}, or force, or terrain"
    return Map("dt-alpha", knob, drives.shallow_water, WATER, [], 1.0, predicted, octaves=6, steps=80)


def _plane(v):
    return ["terrain.shape=plane", f"terrain.parameters={{slope={v!r}}}"]


def _steps_on_slopes(scene):
    """Water that runs down a dry plane, ever steeper."""
    predicted = f"Courant number {scene.solver.cfl:g}, or force, or terrain"
    return Map("dt-slope", Axis("slope", "", _plane, spread(0.02, 5)), drives.shallow_water, WATER, [], 1.0, predicted, octaves=6, steps=80)


def _slope(scene, depth):
    """A plane of some slope, water of some depth on it; steps as the plan chooses."""
    across = Axis("slope", "", _plane)
    knob = Axis("depth", "m", _deep, spread(0.05 * depth, 2 * depth))
    predicted = "the plan warns of steeper ones: water gets too fast there, not unstable"
    return Map("slope-depth", knob, drives.shallow_water, WATER, [], 1.0, predicted, across, STEEP, octaves=5, steps=80)
