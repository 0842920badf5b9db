"""Incompressible and viscous liquids: one outer step, stage by stage. "Sn" is the stage of the slime spec, section 1.2.

Liquid particles are the nodes on which all dynamics happens. Where a scene has APIC particles, these carry mass,
momentum and affine velocity: in every sub-step nodes get both from them (claim 2 of the source, steps 1.1-1.4), and hand
the new velocity back (1.6-1.9). Air ghost particles complete the density at the free surface and live for one sub-step.
Solvers are in `melt.systems.incompressible`. Positions and velocities live at t^n.
"""

import numpy as np

from melt.errors import NotFinite
from melt.fields_slime import APIC_CARRIED
from melt.slime.build import flow
from melt.slime.motion import motion_of
from melt.slime.nodes import tend
from melt.systems import incompressible as solve
from melt.systems.heat import heat, start_heat
from melt.systems.incompressible import step_limits, sub_steps, tally, tell  # noqa: F401  (step_limits: asked of every page)
from melt.systems.melting import emit, grown, search, sort

#: What a sub-step derives and later readers expect beside its particle after another sort.
DERIVED = ("volume", "node_state", "held", "density_ratio", "completed_ratio", "viscosity")
RELAX_STEP = 1e-5  # [s] so short that nothing falls in it; displacements do not depend on it


def start(do):
    """Derive thermal properties; nothing else is needed before the first step."""
    if do.need.heat:
        start_heat(do)
    if do.need.shift:  # of half a rho, for the sum of both of a pair
        do.give("background_pressure", np.full(do.size("particle"), 0.5 * do.settings.density))
    if do.need.apic and not do.clock.apic:
        do.clock.apic = int((np.asarray(do.read("apic_phase")) == 0).sum())
    if do.clock.step == 0:
        if do.settings.relax:
            relax(do)
        if do.need.apic:
            centre(do)


def relax(do):
    """Take the overlap out of a start: the density solve moves particles, velocities stay as they were (spec 4).

    Disorder overlaps, and so do nodes with APIC particles: those at a surface share the mass with fewer others, so that
    they are a tenth too heavy. Left alone, the first step would take this for compression and make velocity of it.
    """
    kept = [(name, of, _by_id(do, name, of)) for name, of in _VELOCITIES if name == "velocity" or do.need.apic]
    before = {name: _by_id(do, *_PLACES[name]) for name, _, _ in kept if name in _PLACES}
    for _ in range(do.settings.relax):
        if do.need.apic:
            gather(do)
        for name, _, _ in kept:
            do.give(name, np.zeros_like(do.read(name)))
        do.keep_motion()
        listed(do)
        if do.need.apic:
            do.reorder(("volume", "node_state"))
        else:
            do.liquid_volume()
        solve.operators(do)
        solved = solve.density(do, RELAX_STEP, "density_ratio")
        if do.need.apic:
            do.nodes_to_apic(dt=RELAX_STEP)
            do.apic_move(dt=RELAX_STEP)
        do.advect(dt=RELAX_STEP)
        if solved.largest == 0:
            break
    for name, of, values in kept:
        if do.settings.flow is not None and name in before:  # the flow at where they are now
            there, was = flow(do.settings.flow, _by_id(do, *_PLACES[name])), flow(do.settings.flow, before[name])
            values = values + (there - was)
        do.give(name, np.ascontiguousarray(values[:, np.argsort(np.argsort(do.read(of), kind="stable"), kind="stable")]))
    do.give("density_impulse", np.zeros_like(do.read("density_impulse")))


def centre(do):
    """Take the velocities of APIC particles, given where they are, to the weighted centroids of their nodes, where they count."""
    C = np.asarray(do.read("apic_affine"), np.float64)
    if not C.any():
        return
    gather(do)
    C, v = (np.asarray(do.read(name), np.float64) for name in ("apic_affine", "apic_velocity"))
    v += np.einsum("abn,bn->an", C.reshape(3, 3, -1), np.asarray(do.read("apic_centre"), np.float64))
    do.give("apic_velocity", v)


_PLACES = {"velocity": ("position", "id"), "apic_velocity": ("apic_position", "apic_id")}
_VELOCITIES = (("velocity", "id"), ("apic_velocity", "apic_id"), ("apic_affine", "apic_id"))


def _by_id(do, name, of):
    return do.read(name)[:, np.argsort(do.read(of), kind="stable")]


def step(do, dt):
    """Advance the state by one outer step of ``dt`` seconds."""
    if do.need.inflow:
        emit(do, dt)  # S1
    n_sub, sub_dt = sub_steps(do, dt)
    do.clock.tally = {}
    try:
        for _ in range(n_sub):
            advance(do, sub_dt, do.settings.retries)
        solve.mean_loads(do, dt)
        if do.need.heat:
            listed(do)  # the lists of the last sub-step name particles that have left since
            do.reorder(DERIVED)
            heat(do, dt)
        report(do, dt)
    except NotFinite:  # the caller names what and where
        do.clock.max_speed = float("inf")
    do.clock.step += 1


def advance(do, dt, retries):
    """Advance by a sub-step; one whose solves do not converge is tried again in two halves, or stops the run."""
    s = do.settings
    if do.need.apic:
        gather(do)  # S2-S4: v^n, m^n of the nodes
    do.keep_motion()  # S0
    found = forces(do, dt)
    failed = [f for f in found if not f.converged]
    if do.recording:  # whether or not it comes to that
        do.restore_motion()
    if failed and s.on_fail == "retry" and retries > 0 and all(f.finite for f in failed):
        do.restore_motion()
        forget_pressure(do)
        tally(do, "retries", 1)
        advance(do, dt / 2, retries - 1)
        advance(do, dt / 2, retries - 1)
        return
    if failed:
        if s.on_fail != "warn" and all(f.finite for f in failed):
            do.restore_motion()  # what is left is the state before this sub-step
        if all(f.finite for f in failed):  # else who is not finite is yet to be named
            forget_pressure(do)
        tell(do, dt, failed)
    solve.tally_loads(do, found, dt)
    if do.need.semi_lagrangian:
        do.restore_motion(velocity_kept="velocity")  # back to x^n, with v^(n+1)
        if do.need.apic:
            sort(do)
            do.reorder(DERIVED)
    if do.need.apic:
        do.nodes_to_apic(dt=dt)  # S10: v^(n+1), C^(n+1)
        do.apic_move(dt=dt)  # S12
        if do.need.elastic:
            do.apic_strain(dt=dt)
    do.advect(dt=dt, velocity=transport(do, dt))  # S11: x^n -> x^(n+1)
    if do.need.domain:
        do.leave_domain()
        if do.need.apic:
            do.leave_domain(position="apic_position", phase="apic_phase")
    do.clock.time += dt
    do.clock.previous_dt = dt


def transport(do, dt):
    """Return the field of the velocity that moves the particles: their own, or one with the shift that keeps them in order.

    A constant pressure acts on nothing but disorder: by -shift sum_j V_j grad W (Adami et al. 2013; Lind et al. 2012).
    """
    if not do.need.shift:
        return "velocity"
    do.restore_motion(position_kept="position", velocity_kept="velocity", position="position", velocity="velocity_transport")
    do.pressure_acceleration(solver_pressure="background_pressure")
    do.pressure_kick(velocity="velocity_transport", dt=do.settings.shift / dt)
    return "velocity_transport"


def forget_pressure(do):
    """Begin the next solves at zero: what led nowhere is no first guess."""
    for name in ("poisson_pressure", "density_impulse", "divergence_impulse", "viscous_pressure"):
        if do.has(name):
            do.give(name, np.zeros_like(do.read(name)))


def gather(do):
    """Sort nodes and APIC particles by cell, and give nodes the mass and momentum that APIC particles carry (S2-S4)."""
    sort(do)
    do.cell_index(position="apic_position", phase="apic_phase", cell="apic_cell")
    do.cell_sort(cell="apic_cell", order="apic_order", cell_start="apic_start", arrival="apic_arrival")
    do.reorder(APIC_CARRIED, "apic_order")
    do.apic_weights()
    do.liquid_volume()  # of walls and bodies
    do.apic_to_nodes()


def forces(do, dt):
    """Solve for v^(n+1), where the particles are or (S14) where they arrive; return what each solve came to."""
    s = do.settings
    found = []
    for arrival in range(s.arrivals):
        if do.need.semi_lagrangian:
            do.advect(dt=dt)  # X_a = x^n + dt v of the last guess
            do.restore_motion(position_kept="position")  # v^n anew
        found = velocities(do, dt)
        for f in found:
            solve.told(do, f)
        if arrival + 1 < s.arrivals:
            do.slime_bounds(dt=dt)
            missed = float(np.asarray(do.read("slime_bounds"))[2].max())
            if missed <= 0.1 * s.support:
                break
    do.note("arrivals", arrival + 1)
    return found


def velocities(do, dt):
    """v^n -> v^(n+1): body forces, viscosity, pressure (S5-S9)."""
    need, found = do.need, []
    listed(do)  # S2
    if need.apic:
        do.reorder(("volume", "node_state"))  # nodes got them before they were sorted for the lists
    else:
        do.liquid_volume()
    boundaries(do, dt)
    solve.operators(do)  # S5b
    if need.apic:
        do.massless_velocity()
    if need.ghosts:
        air(do)  # S5a
    if do.settings.early_divergence and need.dfsph:
        found.append(solve.divergence(do, dt))
    push(do, dt)  # S6a
    if need.viscosity:
        found.append(solve.viscous(do, dt))  # S6b
    if need.poisson:
        found.append(solve.project(do, dt))  # S7
    if need.dfsph:
        if not do.settings.early_divergence:
            found.append(solve.divergence(do, dt))  # S8
        found.append(solve.density(do, dt))  # S9
    return found


def listed(do):
    """Sort nodes by cell and list the neighbours of each (S2)."""
    if not do.need.periodic:
        return search(do)
    sort(do)
    do.neighbours_periodic()
    if grown(do, "neighbour", "neighbour_count"):
        do.neighbours_periodic()


def boundaries(do, dt):
    """Velocities that are given: of moving bodies, and of liquid inside a nozzle."""
    if do.need.drivers:
        do.give("driver_motion", motion_of(do.settings.bodies, do.clock.time, dt))
        do.drive(position="position_kept")  # where they are at t^n, also while forces are solved at the arrival
    if do.need.nozzles:
        do.nozzle_hold()


def air(do):
    """Seed air ghost particles beyond the free surface, and complete the density by them (S5a). Spec 2.8."""
    do.ghost_candidates()
    do.ghost_thin()
    do.ghost_list()
    count = int(do.read("ghost_start")[-2]) if not do.recording else 0
    if count > do.size("ghost"):
        do.resize("ghost", count + count // 4)
    do.ghost_place()
    do.ghost_volume()
    do.ghost_complete()
    do.note("ghosts", count)


def push(do, dt):
    """Body forces on the nodes (S6a)."""
    need = do.need
    do.weight()
    if need.buoyancy:
        do.buoyancy()
    if need.drag:
        do.drag()
    if need.surface_tension:
        do.surface_tension()
    if need.elastic:
        do.elastic_force(dt=dt)
    do.free_kick(dt=dt)


def report(do, dt):
    """Read the largest speed and affine velocity back, once per outer step."""
    do.total_pressure(dt=do.clock.previous_dt or dt)
    do.slime_bounds(dt=0.0)
    speed, affine, _ = np.asarray(do.read("slime_bounds"), np.float64).max(axis=1)
    do.clock.max_speed, do.clock.largest_affine = float(speed), float(affine)
    if do.need.apic:
        do.apic_sums()
        orphans, mass, _ = np.asarray(do.read("apic_sums"), np.float64).sum(axis=1)
        do.note("orphans", int(orphans))
        do.note("orphan_mass", float(mass))
        if tend(do):  # S13
            sort(do)  # the next layer of a nozzle enters behind them
            do.reorder(DERIVED)
