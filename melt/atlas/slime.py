"""Maps of incompressible and viscous liquids. Slime spec 2.12."""

import math

from melt.atlas import drives
from melt.atlas.alarms import COMPRESSION, ENERGY, SPEED
from melt.atlas.maps import Axis, Map, spread

ALARMS = (ENERGY, SPEED, COMPRESSION)
BASE = ["time.n_sub=1", "solver.dfsph.on_fail=raise"]
INVISCID = [*BASE, "viscosity=none"]  # what viscosity damps tells nothing of the other bounds
PREDICTED = "least of speed, gravity, affine motion"


def maps(scene):
    """Return the maps that apply to a scene."""
    if scene.solid:
        return []
    found = [_viscosity(scene)]
    if scene.solver.ghosts is not None and scene.solver.pressure != "dfsph":
        found.append(_tension(scene))
    if scene.solver.apic is not None:
        found.append(_elastic(scene))
    return found


def _gravity_step(scene):
    """Return the bound that gravity sets [s], or that of a metre per second."""
    g = math.sqrt(sum(c * c for c in scene.domain.gravity))
    return 0.25 * math.sqrt(scene.spacing / g) if g > 0 else 0.4 * scene.spacing


def _viscosity(scene):
    mu = scene.viscosity.mu if scene.viscosity is not None and scene.viscosity.mu > 0 else 10.0
    explicit = ("explicit viscosity, 0.125 h_s^2/nu", lambda v: 0.125 * (0.5 * scene.support) ** 2 * scene.fluid.density / v)
    knob = Axis("viscosity", "Pa s", lambda v: [f"viscosity.mu={v!r}"], spread(1e-4 * mu, 100 * mu))
    return Map("dt-viscosity", knob, drives.mechanics, ALARMS, BASE, 1.0, PREDICTED, also=(explicit,), octaves=5, steps=60)


def _tension(scene):
    """Tensions about the one whose bound is that of gravity."""
    rho, d = scene.fluid.density, scene.spacing
    even = rho * d**3 / (2 * math.pi * _gravity_step(scene) ** 2)
    knob = Axis("surface tension", "N/m", lambda v: [f"fluid.sigma={v!r}"], spread(0.1 * even, 100 * even))
    # a square that becomes a disc frees 0.9 of the energy scale, which the ledger has as a gain
    alarms = (ENERGY._replace(noisy=1.0), SPEED, COMPRESSION)
    return Map("dt-tension", knob, drives.mechanics, alarms, INVISCID, 1.0, f"{PREDICTED}, sqrt(rho d^3/(2 pi sigma))", octaves=5, steps=60)


def _elastic(scene):
    even = scene.fluid.density * (0.3 * scene.spacing / _gravity_step(scene)) ** 2
    knob = Axis("elastic modulus", "Pa", lambda v: [f"elastic.modulus={v!r}"], spread(0.1 * even, 100 * even))
    return Map("dt-elastic", knob, drives.mechanics, ALARMS, INVISCID, 1.0, f"{PREDICTED}, 0.3 d sqrt(rho/G)", octaves=5, steps=60)
