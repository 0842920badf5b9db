"""How a run of a map is stepped: by a multiple of the bound of now, whatever a plan would have chosen.

A drive takes a simulation and the multiple, advances by one step and returns (its length [s], the bound that governed).
"""

import math

import numpy as np

from melt.errors import MeltError, NotFinite
from melt.scales import explicit_heat_limit
from melt.systems import flood, heat, liquid_heat, melting

LONGEST = 1e6  # s: where nothing bounds a step


def mechanics(sim, factor):
    """One outer step of one sub-step (time.n_sub = 1)."""
    limits = sim.prepared.system.step_limits(sim.do)
    governing = min(limits, key=limits.get)
    dt = min(factor * limits[governing], LONGEST)
    sim.step(dt)
    return dt, governing


def _still(sim, dt):
    """Count a step of a page of its own, and look at its values as `Simulation.step` does."""
    sim.do.clock.step += 1
    sim.do.clock.time += dt
    sim.check()


def _listed(do):
    """Find the neighbours of what does not move, once."""
    if not do.listed:
        melting.search(do)
        melting.volumes(do)
        do.listed = True


def conduction(sim, factor):
    """One step of the scene's heat solver; forward Euler is not divided into the steps that it needs."""
    do = sim.do
    _listed(do)
    heat.properties(do)
    do.heat_conductance()
    dt = min(factor * explicit_heat_limit(sim.scene, do.settings), LONGEST)
    if do.settings.heat_solver == "explicit":
        do.heat_explicit(dt=dt)
        do.swap("temperature", "temperature_next")
    else:
        heat.SOLVERS[do.settings.heat_solver](do, dt)
    _still(sim, dt)
    return dt, "explicit"


def liquid_conduction(sim, factor):
    """One step of conduction in a liquid that would boil, with its heater, not divided; nothing moves."""
    do = sim.do
    if not do.listed:
        melting.search(do)
        do.pbf_begin()
        do.boil_sums()
        do.listed = True
    do.boil_rate()
    rate = liquid_heat.largest(do, "heat_rate")
    dt = factor / rate if rate > 0 else LONGEST
    if do.need.heater:
        liquid_heat.heat(do, dt)
    do.boil_exchange(dt=dt)
    do.swap("temperature", "temperature_next")
    _still(sim, dt)
    return dt, "maximum principle"


def shallow_water(sim, factor):
    """One sub-step of a flood; a factor of 1 is the scene's Courant number."""
    do = sim.do
    try:
        flood.derive(do)
        longest, governing = flood.limit(do)
        dt = min(factor * longest, LONGEST)
        flood.advance(do, dt)
    except NotFinite:
        raise MeltError("a speed, depth or force is not finite") from None
    do.clock.step += 1
    sim.check()
    if not math.isfinite(do.clock.max_speed) or not np.isfinite(dt):
        raise MeltError("the speed is not finite")
    return dt, governing
