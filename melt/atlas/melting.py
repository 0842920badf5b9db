"""Maps of weakly compressible liquids, of solids in them, and of heat. Melting spec 2.5, 2.6."""

import numpy as np

from melt.atlas import drives
from melt.atlas.alarms import COMPRESSION, ENERGY, OVERSHOOT, SIDEWAYS, SPEED
from melt.atlas.maps import Axis, Map, spread
from melt.geometry.build import build
from melt.plan import prepare
from melt.preflight import FINEST, limits

MECHANICAL = (ENERGY, SPEED, COMPRESSION)
ONE_STEP = ["time.n_sub=1"]


def maps(scene):
    """Return the maps that apply to a scene."""
    found = []
    if scene.solver.motion:
        found += [_stiffness(scene), _viscosity(scene)]
        found += [_density(scene)] if scene.solid else [_distance(scene)] if _at_rest(scene) else []
    if scene.heat is not None:
        found += [_conductivity(scene, "explicit"), _conductivity(scene, "cg")]
    return found


def _sound(scene):
    """Return (sound speed, the bounds of a sub-step) of a scene as it is."""
    prepared = prepare(scene, build(scene))
    return prepared.settings.sound_speed, limits(prepared)


def _stiffness(scene):
    c, _ = _sound(scene)
    knob = Axis("sound speed", "m/s", lambda v: [f"fluid.sound_speed={v!r}"], spread(0.5 * c, 8 * c))
    return Map("dt-stiffness", knob, drives.mechanics, MECHANICAL, ONE_STEP, 2.0, "least of 0.4 h_s/(c (1 + 0.6 alpha)), force, speed")


def _viscosity(scene):
    """Viscosities about the one at which its bound is that of sound."""
    h = 0.5 * scene.support
    even = scene.fluid.density * 0.125 * h**2 / _sound(scene)[1]["sound"]
    knob = Axis("viscosity", "Pa s", lambda v: [f"fluid.mu={v!r}"], spread(0.1 * even, 100 * even))
    base = [*ONE_STEP, "fluid.viscosity=laminar"]
    return Map("dt-viscosity", knob, drives.mechanics, MECHANICAL, base, 2.0, "least of sound and 0.125 h_s^2/nu")


def _density(scene):
    rho = scene.fluid.density
    knob = Axis("density of solids", "of the liquid", lambda v: [f"solid.*.density={v * rho!r}"], spread(0.01, 30.0))
    predicted = "sound, times sqrt(ratio/0.05) for solids lighter than that"
    return Map("dt-density-ratio", knob, drives.mechanics, MECHANICAL, ONE_STEP, 2.0, predicted)


def _at_rest(scene):
    """Return whether a scene is water at rest from wall to wall: nothing but noise moves it sideways."""
    if scene.inflow or scene.obstacle or scene.heat or [fill.shape for fill in scene.fluid.fill] != ["box"]:
        return False
    fill, domain = scene.fluid.fill[0], scene.domain
    return all(getattr(fill, corner)[:2] == getattr(domain, corner)[:2] for corner in ("lower", "upper"))


def _distance(scene):
    """The whole scene moved away from the origin in single precision, whose positions get coarser: a domain that large."""
    c, _ = _sound(scene)
    knob = Axis("sound speed", "m/s", lambda v: [f"fluid.sound_speed={v!r}"], spread(0.5 * c, 8 * c))
    boxes = {"domain": scene.domain, "fluid.fill.0": scene.fluid.fill[0]}

    def moved(v):
        return [
            f"{key}.{corner}={[x + v * scene.spacing if axis == 0 else x for axis, x in enumerate(getattr(box, corner))]}"
            for key, box in boxes.items() for corner in ("lower", "upper")
        ]

    across = Axis("distance from the origin", "spacings", moved)
    base = [*ONE_STEP, "solver.precision=single"]
    bound = FINEST / float(np.finfo(np.float32).eps)  # a number is up to twice as fine
    predicted = f"float32 positions {FINEST:g} spacings apart"
    return Map("distance-stiffness", knob, drives.mechanics, (*MECHANICAL, SIDEWAYS), base, 2.0, predicted, across, bound, octaves=20)


def _conductivity(scene, solver):
    solids = ["solid.*.conductivity"] if scene.solid else []
    k = max([scene.heat.conductivity, *(s.conductivity for s in scene.solid)])

    def overrides(v):
        return [f"{key}={v!r}" for key in ("heat.conductivity", *solids)]

    knob = Axis("conductivity", "%" if scene.heat.law == "paper" else "W/(m K)", overrides, spread(0.01 * k, 10 * k))
    base = [f"heat.solver={solver}", "heat.substeps=1", "heat.latent=false", "heat.refreeze=false"]
    predicted = "explicit limit h^2/(14.2 alpha)"
    name = "dt-conductivity-explicit" if solver == "explicit" else "dt-conductivity-implicit"
    return Map(name, knob, drives.conduction, (OVERSHOOT,), base, 0.0, predicted, rows=3, steps=40)
