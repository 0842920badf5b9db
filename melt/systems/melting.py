"""Melting: one outer step, stage by stage. "line n" is the paper's pseudo-code.

An outer step t^n -> t^(n+1) = t^n + dt does heat, melting and topology once, and mechanics in
``n_sub`` sub-steps; with n_sub = 1 it is exactly the paper's order. Leap-frog: positions and
temperatures live at t^n, velocities at t^(n-1/2).
"""

import math

import numpy as np

from melt.errors import NotFinite
from melt.systems import incompressible
from melt.systems.heat import heat, start_heat
from melt.systems.steps import divide
from melt.systems.topology import build_lattice, freeze, melt_and_relink


def start(do):
    """Derive what the first step needs: thermal properties, site links, regions, components."""
    if do.need.heat:
        start_heat(do)
    if do.need.solids:
        build_lattice(do)


def step(do, dt):
    """Advance the state by one outer step of ``dt`` seconds."""
    need, clock = do.need, do.clock
    n_sub, sub_dt = sub_steps(do, dt)
    clock.tally = {}
    if need.inflow:
        emit(do, dt)
    for s in range(n_sub):
        search(do)  # line 1-2
        if s == 0:
            solidify(do, sub_dt)
        volumes(do)
        if not need.incompressible:
            do.density()  # line 4, eq (1): rho^n
            do.tait_pressure()  # p^n
            do.boundary_pressure()  # what solids and walls carry in (2')
        forces(do, sub_dt)  # line 5-7: F(x^n, v^(n-1/2))
        if s == 0:
            liquefy(do)  # line 9-10: tests T^n
        if s == n_sub - 1 and need.heat:
            heat(do, dt)  # line 13, eq (4): T^n -> T^(n+1)
        if need.solids:
            shape(do, dt, sub_dt)  # line 11: goals from x^n
        try:
            move(do, sub_dt)  # line 14: v^(n-1/2) -> v^(n+1/2), x^n -> x^(n+1)
        except NotFinite:  # the caller names what and where
            clock.max_speed = math.inf
            break
    else:
        keep_bounds(do)
    clock.step += 1


def still_step(do, dt):
    """Advance heat and phase change alone: nothing moves (static scenes)."""
    if not do.listed:  # once per run (or resume): the lists stay valid
        search(do)
        volumes(do)
        do.listed = True
    changed = solidify(do, dt)
    if liquefy(do) or changed:  # nothing else moves, grows or shrinks
        volumes(do)
    if do.params["heat"].current_volume:  # V = m/rho
        do.density()
    heat(do, dt)
    do.clock.step += 1


def liquefy(do):
    """Melt, at the scene's cadence; return whether something did."""
    return do.need.melting and do.clock.step % do.settings.melt_every == 0 and melt_and_relink(do)


def solidify(do, sub_dt):
    """Freeze, at the scene's cadence; return whether something did.

    Not in the paper. Before the forces, so that what froze is solid in all of them; it was put on its
    site, so all that follows, heat too, works with lists and distances made anew.
    """
    if not do.need.freezing or do.clock.step % do.settings.melt_every != 0 or not freeze(do, sub_dt):
        return False
    search(do)
    return True


def search(do):
    """Sort particles by cell and list the neighbours of each (line 1-2)."""
    sort(do)
    if do.need.solids:
        do.site_particle()
    if do.settings.neighbours == "kdtree":
        do.kdtree_build()
    list_neighbours(do)
    if grown(do, "neighbour", "neighbour_count"):
        list_neighbours(do)


def sort(do):
    """Bring particles into the order of their cells, inactive ones last."""
    do.cell_index()
    do.cell_sort()
    do.reorder()


def grown(do, extent, count):
    """Return whether lists had to grow: they hold the true count even when they overflow, so nothing is lost."""
    longest = int(do.read(count).max(initial=0))
    if longest <= do.size(extent):
        return False
    row = 8 if do.need.incompressible else 16  # rows of whole cache lines, or as short as they can be
    do.resize(extent, row * (longest // row + 1))
    return True


def list_neighbours(do):
    """Fill the neighbour lists; grid and KD-tree give the same ones."""
    if do.settings.neighbours == "kdtree":
        do.neighbours_kdtree()
    else:
        do.neighbours_grid()


def volumes(do):
    """Volumes by which particles enter SPH sums."""
    do.liquid_volume()
    if do.need.solids:
        if do.settings.solid_volume == "rest":
            do.solid_volume_rest()
        else:
            do.solid_volume_akinci()


def forces(do, sub_dt):
    """All forces at x^n; solids get the exact reaction by gather (line 5-7)."""
    if do.need.incompressible:
        do.weight()
    else:
        do.fluid_force()
        if do.need.solids:
            do.reaction_force()
    if do.need.laminar:
        do.laminar_force()
    if do.need.contact:
        do.contact_force(dt=sub_dt)
    if do.need.buoyancy:
        do.buoyancy()
    if do.need.drag:
        do.drag()
    if do.need.surface_tension:
        do.surface_tension()


def shape(do, dt, sub_dt):
    """Goal displacements g - x from the region rotations, and damping towards rigid motion."""
    if do.settings.rigid:
        do.rigid_match()
        do.rigid_goal()
        return
    do.region_match()
    do.goal()
    if do.settings.lattice_damping > 0:
        do.region_motion()
        # damping per outer step, spread over its sub-steps
        do.damp_velocity(factor=1.0 - (1.0 - do.settings.lattice_damping) ** (sub_dt / dt))


def move(do, sub_dt):
    """Kick, drift, and push apart what came too close."""
    clock = do.clock
    # the first kick is a half one: v^0 -> v^(1/2)
    if do.need.incompressible:
        squeeze(do, sub_dt)
    elif do.settings.leap_frog == "kdk":
        do.kick(dt=0.5 * clock.previous_dt)  # v^n
        forces(do, sub_dt)  # again, with v^n
        do.kick(dt=0.5 * sub_dt)
    else:
        do.kick(dt=0.5 * (clock.previous_dt + sub_dt))
    if do.need.solids:
        do.goal_kick(dt=sub_dt)
    if do.need.xsph:
        do.xsph()
        do.swap("velocity", "velocity_next")
    do.drift(dt=sub_dt)
    if do.need.xsph:  # positions move with the blend, velocities stay as they are
        do.swap("velocity", "velocity_next")
    if do.need.guard:
        do.guard_offenders()
        do.guard_correction()
        do.swap("position", "position_next")
        do.swap("velocity", "velocity_next")
    if do.need.domain:
        do.leave_domain()
    clock.previous_dt = sub_dt
    clock.time += sub_dt


def squeeze(do, sub_dt):
    """Kick, then make velocities keep the density of the liquid; solids and liquid push each other alike (slime S8, S9)."""
    do.kick(dt=sub_dt)
    incompressible.operators(do)
    solves = (incompressible.divergence, incompressible.density)
    found = [solve(do, sub_dt) for solve in solves]
    for f in found:
        incompressible.told(do, f)
    incompressible.tell(do, sub_dt, [f for f in found if not f.converged])


def emit(do, dt):
    """Let every layer enter whose time falls into this outer step (stage 0)."""
    clock = do.clock
    for nozzle in do.settings.nozzles:
        while True:
            k = clock.layers[nozzle.name]
            enters = nozzle.start + k * nozzle.interval
            if k >= nozzle.layers or enters >= clock.time + 0.5 * dt:
                break
            if clock.active + nozzle.count > do.settings.capacity:
                do.note("inflow_stopped", clock.step + 1)
                clock.layers[nozzle.name] = nozzle.layers
                break
            where = dict(first=nozzle.first, count=nozzle.count, slot=clock.active)
            do.emit_motion(lag=clock.time - enters, **where)
            do.emit_matter(**where)
            if do.need.apic:
                do.emit_apic(lag=clock.time - enters, **where | {"slot": clock.apic})
                clock.apic += nozzle.count * do.settings.apic_per_node
            clock.active += nozzle.count
            clock.layers[nozzle.name] = k + 1
            clock.entered[nozzle.name] = clock.entered.get(nozzle.name, 0) + 1


def step_limits(do):
    """Return {bound: seconds} of the mechanical sub-step. Spec 2.6."""
    if do.need.incompressible:
        return incompressible.step_limits(do)
    s, clock = do.settings, do.clock
    h_s = 0.5 * s.support
    sound = 0.4 * h_s / (s.sound_speed * (1.0 + 0.6 * s.alpha))
    acceleration = max(clock.max_acceleration, s.gravity, 1e-12)
    limits = {
        "sound": sound,
        "force": 0.25 * math.sqrt(h_s / acceleration),
        # a particle may not cross half a spacing: only jets and falls beyond the sound speed's design reach it
        "speed": 0.4 * h_s / max(clock.max_speed, 1e-12),
    }
    if s.kinematic_viscosity > 0:
        limits["viscosity"] = 0.125 * h_s**2 / s.kinematic_viscosity
    if s.lightest_solid < 0.05:
        limits["light solid"] = sound * math.sqrt(s.lightest_solid / 0.05)
    return limits


def sub_steps(do, dt):
    """Return (n_sub, dt / n_sub) of an outer step; see `melt.systems.steps.divide`."""
    if do.need.incompressible:
        return incompressible.sub_steps(do, dt)
    speeds = f"largest speed {do.clock.max_speed:.3g} m/s, sound speed {do.settings.sound_speed:.3g} m/s"
    return divide(do, dt, step_limits(do), speeds, "lower fluid.sound_speed", "motion_bounds")


def keep_bounds(do):
    """Read the largest speed and acceleration back, once per outer step."""
    do.motion_bounds()
    speed, acceleration = np.asarray(do.read("motion_bounds"), dtype=np.float64).max(axis=1)
    do.clock.max_speed, do.clock.max_acceleration = float(speed), float(acceleration)
