"""Flood: one outer step, stage by stage. "n" is the stage of the flood spec, section 1; "En" its equation.

Columns of water of fixed volume stand on the terrain; the SPH sum of their volumes is the depth. An outer step is
cut into sub-steps as the water asks for. Leap-frog: positions and depths live at t^n, velocities at t^(n-1/2), so
that the kicks (3, 10) of two steps are one.
"""

import math

import numpy as np

from melt.errors import NotFinite, Unstable
from melt.flood import edges, sources
from melt.flood.limits import limit
from melt.systems.melting import grown, sort
from melt.systems.reads import finite
from melt.systems.steps import count


def start(do):
    """Solve depth and support once, so that the first frame has them, and take the first reading of the maps."""
    do.clock.next_id = do.settings.capacity  # every slot has an id; what enters gets a new one
    do.clock.largest_support = do.settings.start_support
    do.clock.ledger["volume_start"] = math.fsum(np.asarray(do.read("rest_volume"), dtype=np.float64))
    locate(do)
    water(do)
    sample(do, 0.0)


def step(do, dt):
    """Advance the state by one outer step of ``dt`` seconds."""
    try:
        outer_step(do, dt)
    except NotFinite:
        do.clock.max_speed = math.nan  # `Simulation.step` tells which column
    do.clock.step += 1


def outer_step(do, dt):
    """Settle, let water in, advance in sub-steps, take readings."""
    if do.clock.time == 0 and do.settings.settle > 0:
        settle(do)
    if do.need.entry:
        enter(do, dt)  # 2
    left, n, do.warning = dt, 0, ""
    while left > 1e-9 * dt:
        derive(do)  # at t^n
        sub_dt = next_step(do, dt, left)
        advance(do, sub_dt)  # to t^(n+1)
        left -= sub_dt
        n += 1
    do.note("n_sub", n)
    if do.need.infiltration:
        seep(do, dt)
    locate(do)
    water(do)
    sample(do, dt)


def derive(do):
    """All that follows from where the columns are."""
    locate(do)
    water(do)
    if do.need.control and (do.clock.sub_step > 0 or do.recording):
        do.control_brake()  # 8: of the last move
    forces(do)
    do.flood_bounds()
    if do.need.airborne:  # last: what landed has a depth of its own from the next solve on
        do.flood_land()


def rings(do):
    """Return how many rings of cells the largest support reaches, growth in the next solve included."""
    s = do.settings
    return max(1, math.ceil(s.growth * max(do.clock.largest_support, s.least_reach) * s.inverse_cell))


def locate(do):
    """Sort columns by cell and list the neighbours of each (5)."""
    sort(do)
    do.cell_support()
    do.cell_reach(rings=rings(do), empty=0)
    do.flood_neighbours()
    if grown(do, "neighbour", "neighbour_count"):
        do.flood_neighbours()
    if do.need.walls:
        do.wall_neighbours()
        if grown(do, "wall_neighbour", "wall_count"):
            do.wall_neighbours()


def water(do):
    """Bed under the columns, then depth and support together (6, 7)."""
    clock, s = do.clock, do.settings
    do.bed()
    do.flood_depth()
    clock.largest_support = min(s.growth * clock.largest_support, s.largest_support)  # until `limit` measures it
    do.flood_surface()  # E4


def forces(do):
    """Pressure, bed, stabilisation, walls (9)."""
    if do.need.balanced:
        do.balanced_force()
        return
    do.flood_force()
    if do.need.walls:
        do.wall_force()
    if do.need.constrained:
        do.bed_curvature()
        do.constrain_to_bed()


def advance(do, sub_dt):
    """Kick, drag, drift, and keep the columns where water may be (10, 11, 3, 4)."""
    clock = do.clock
    # the first kick is a half one: v^0 -> v^(1/2)
    previous = clock.previous_dt if clock.sub_step or do.settings.first_kick == "half" else sub_dt
    do.flood_kick(dt=0.5 * (previous + sub_dt))
    if do.need.drag:
        do.flood_drag(dt=0.5 * (previous + sub_dt))
    if do.need.zones:
        edges.drive(do)
    do.flood_drift(dt=sub_dt)
    do.flood_guard()
    if do.need.outlets:
        leave(do, ("left_edge", do.settings.blocked_ledger))
    clock.previous_dt = sub_dt
    clock.time += sub_dt
    clock.sub_step += 1


def leave(do, names):
    """Book the volume that left in this sub-step."""
    rows = np.asarray(do.read("left_volume"), dtype=np.float64)
    for name, row in zip(names, rows):
        if name:
            do.clock.ledger[name] = do.clock.ledger.get(name, 0.0) + finite(math.fsum(row))


def seep(do, dt):
    """Let water seep away, in portions that single precision can take from a column (E19)."""
    s, kept = do.settings, do.clock.sources
    waited = kept.get("seconds to seep", 0.0) + dt
    kept["seconds to seep"] = waited if s.infiltration * waited < s.least_seepage else 0.0
    if kept["seconds to seep"] == 0.0:
        do.infiltrate(rate=s.infiltration, thinnest=s.thinnest, dt=waited)
        leave(do, (None, None, "infiltrated", "dried"))


def enter(do, dt):
    """Let the columns enter that the inflows bring in this outer step (2)."""
    sort(do)  # the free slots stand behind the others now
    do.clock.active = int(do.read("cell_start")[-2:][0])
    for rows in sources.entries(do, dt):
        sources.choose(do, rows)
        do.enter(count=rows.count, slot=do.clock.active, density=do.settings.density, first_id=do.clock.next_id)
        do.clock.active += rows.count
        do.clock.next_id += rows.count


def sample(do, dt):
    """Depth at the points of maps and at gauges (12)."""
    if not do.need.samples:
        return
    s = do.settings
    do.cell_support()
    do.cell_reach(rings=rings(do), empty=1)
    do.flood_sample()
    do.keep_most(time=do.clock.time, dt=dt)
    if s.gauges and (do.recording or dt == 0 or (do.clock.step + 1) % s.gauge_every == 0):
        sources.read_gauges(do)


def settle(do):
    """Relaxation start: let the water come to rest before t = 0 (E6, judgement b).

    It falls freely until its kinetic energy peaks, and is stopped there. A drag of fixed time constant instead left
    4 times the force on columns that were drawn: too weak for stiff modes, too strong for soft ones.
    """
    clock, s = do.clock, do.settings
    spent, pull = 0.0, math.inf
    while spent < s.settle and pull > s.settle_speed:
        derive(do)
        sub_dt = min(limit(do)[0], s.settle - spent)
        pull = 0.5 * s.support * clock.max_acceleration * s.settle_time  # speed that the force gives in that time
        if power(do) < 0:
            do.damp_columns(factor=0.0)
        do.flood_kick(dt=sub_dt)
        do.flood_drift(dt=sub_dt)
        do.flood_guard()
        spent += sub_dt
        clock.sub_step += 1
    do.damp_columns(factor=0.0)
    do.note("settled_speed", pull)
    clock.previous_dt, clock.sub_step = 0.0, 0


def power(do):
    """Return sum V a . v [m^5/s^3], what the kinetic energy gains."""
    if do.recording:
        return 0.0
    a, v, V = (np.asarray(do.read(name), dtype=np.float64) for name in ("acceleration", "velocity", "rest_volume"))
    return float((V * (a * v[:2]).sum(axis=0)).sum())


def next_step(do, dt, left):
    """Return the sub-step [s]: the rest of the outer step in the fewest equal parts that the limits allow.

    Raises:
        Unstable: a column is faster than anything in the scene could be, or the limits ask for too many sub-steps.
    """
    s, clock = do.settings, do.clock
    longest, governing = limit(do)
    if do.recording:
        return left  # what it reads are no values
    if clock.max_speed > s.top_speed:
        raise Unstable(
            f"t = {clock.time:.5g} s: a column moves at {clock.max_speed:.3g} m/s, faster than solver.top_speed = {s.top_speed:g} m/s.",
            remedy="Steep terrain makes shallow water fast: add a [control] section, smooth the terrain, or raise solver.top_speed.",
            speed=s.top_speed,
        )
    n = count(do, left, longest)
    if s.n_sub:
        n = max(1, round(s.n_sub * left / dt))
        if dt / s.n_sub > longest * 0.7 / s.cfl * 1.0001:
            do.warning = (
                f"time.n_sub = {s.n_sub} makes sub-steps of {dt / s.n_sub:.3g} s, above a Courant number of 0.7 ({governing}). "
                f"Fix: time.n_sub = {math.ceil(dt / longest)}, or 'auto'"
            )
            n = max(n, math.ceil(left / (longest * 0.7 / s.cfl) * (1 - 1e-9)))
    elif n > s.n_sub_max:
        raise Unstable(
            f"time step: at t = {clock.time:.4g} s the bound '{governing}' allows sub-steps of {longest:.3g} s, {n} of them in "
            f"what is left of dt = {dt:g} s, but time.n_sub_max is {s.n_sub_max}: lower time.dt or raise time.n_sub_max.",
            stage="flood_bounds",
        )
    do.note("governing_bound", "given" if s.n_sub else governing)
    do.note("step_over_limit", left / n / longest)
    return left / n

